// See volumes_outcome.h.
#include "explain/volumes/volumes_outcome.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "mechanism/mechanism.h"
#include "report/colour_map.h"
#include "report/number_text.h"
#include "stats/intervals.h"

namespace gonio::explain {
namespace {

using volumes::Observed, volumes::Reading, volumes::Row;

struct Dot {
  double across = 0, up = 0, value = 0;
};

// Circles in a square from -1 to 1, coloured from blue (-scale) by white to red.
std::string dots_svg(const std::vector<Dot>& dots, double scale) {
  std::string svg =
      "<svg viewBox=\"-1.05 -1.05 2.1 2.1\" role=\"img\" style=\"background:#ddd;min-width:min(22rem,85vw)\">";
  char text[120];
  for (const Dot& d : dots) {
    const std::string colour = report::hex(report::signed_colour(std::clamp(d.value / scale, -1.0, 1.0)));
    std::snprintf(text, sizeof text, "<circle cx=\"%.3f\" cy=\"%.3f\" r=\"0.018\" fill=\"%s\"/>", d.across, -d.up,
                  colour.c_str());
    svg += text;
  }
  return svg + "</svg>";
}

double typical_sigma(const Observed& o, Reading reading) {
  std::vector<double> sigma;
  for (const Row& row : o.rows)
    if (row.reading == reading) sigma.push_back(row.sigma);
  return sigma.empty() ? 0 : stats::median(sigma);
}

void add_pictures(const Observed& o, const std::vector<double>& left, const std::string& when, Illustration& into) {
  const double reach = std::max(o.field_m, o.half_height_m);
  for (const bool walls : {true, false}) {
    const double scale = 3 * typical_sigma(o, walls ? Reading::wall : Reading::inside);
    if (!(scale > 0)) continue;
    for (const bool above : {true, false}) {
      std::vector<Dot> dots;
      for (std::size_t i = 0; i < o.rows.size(); ++i) {
        const Row& row = o.rows[i];
        if (row.reading != (walls ? Reading::wall : Reading::inside)) continue;
        dots.push_back({row.at_m.x / reach, (above ? row.at_m.y : row.at_m.z) / reach, left[i] / weight_of(row)});
      }
      char title[160];
      std::snprintf(title, sizeof title, "%s, %s, seen %s; red: %+.2g %s",
                    walls ? "Walls" : "Grey values of the material", when.c_str(),
                    above ? "along the rotation axis" : "from the side", scale,
                    walls ? "voxel outwards" : "of material less air");
      into.pictures.push_back({title, "", dots_svg(dots, scale)});
    }
  }
}

}  // namespace

std::string volumes_remarks(const VolumesInput& input, const Observed& o, const Problem& problem,
                            const Explanation& e) {
  std::array<std::size_t, volumes::readings> count{};
  for (const Row& row : o.rows) ++count[static_cast<std::size_t>(row.reading)];
  char text[400];
  std::snprintf(
      text, sizeof text,
      "%zu walls, %zu edge widths, %zu grey values of the material and %zu of air were read at %zu places of "
      "%s; %zu stood out of their neighbours and were left out. The shape was moved by %.3g voxels and turned "
      "by %.3g degrees to where the volume has it.",
      count[0], count[1], count[2], count[3], o.sites, input.mesh_name.c_str(), o.left_out, norm(o.moved_m) / o.voxel_m,
      norm(o.turned_rad) * 180 / pi);
  std::string words = text;
  for (std::size_t p = 0; p < problem.parameters().size(); ++p) {
    const Parameter& parameter = problem.parameters()[p];
    if (!parameter.name.ends_with("edge_width_within_slices") || p >= e.values.size()) continue;
    std::snprintf(text, sizeof text, " Edges within slices have a standard deviation of %.2f voxels%s.", e.values[p],
                  e.values[p] >= parameter.upper ? " or more" : "");
    words += text;
  }
  return words;
}

void upgrade_volumes(const VolumesInput& input, const Problem& problem, const Explanation& e,
                     manifest::Document& document) {
  for (std::size_t p = 0; p < problem.parameters().size(); ++p) {
    const std::string& name = problem.parameters()[p].name;
    const std::size_t dot = name.rfind('.');
    if (dot == std::string::npos || std::ranges::find(e.active, p) == e.active.end()) continue;
    if (mechanism::find_mechanism(name.substr(0, dot)) == nullptr) continue;
    manifest::MechanismUse& use = document.mechanisms[name.substr(0, dot)];
    if (std::ranges::find(use.on, input.name) == use.on.end()) use.on.push_back(input.name);
    const auto place = static_cast<std::size_t>(std::ranges::find(use.on, input.name) - use.on.begin());
    std::vector<double>&value = use.parameters[name.substr(dot + 1)].value, &sigma = use.sigma[name.substr(dot + 1)];
    value.resize(use.on.size());
    sigma.resize(use.on.size());
    value[place] = e.values[p];
    sigma[place] = e.sigma[p];
  }
}

Illustration illustrate_volumes(const Observed& o, const Explanation& e) {
  Illustration result;
  add_pictures(o, e.residual_before, "as believed", result);
  if (!e.named.empty()) add_pictures(o, e.residual_after, "with the named physics", result);
  return result;
}

}  // namespace gonio::explain
