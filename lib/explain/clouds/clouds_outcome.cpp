// See clouds_outcome.h.
#include "explain/clouds/clouds_outcome.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/text.h"
#include "camera/intrinsics.h"
#include "inference/wording.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/rig.h"
#include "report/colour_map.h"

namespace gonio::explain {
namespace {

using Part = CloudRole::Part;
constexpr std::size_t most_drawn = 3, cells = 12;

// Root mean square of what a named mechanism does to the rows.
double effect_of(const Problem& problem, const Explanation& e, const Candidate& candidate) {
  std::vector<double> without = e.values;
  for (const std::size_t p : candidate.parameters) without[p] = problem.parameters()[p].neutral;
  const Observations& o = problem.observations();
  double sum = 0;
  for (std::size_t g = 0; g < o.groups(); ++g) {
    std::vector<double> with(o.first[g + 1] - o.first[g]), bare(with.size());
    problem.predict(e.values, g, with), problem.predict(without, g, bare);
    for (std::size_t i = 0; i < with.size(); ++i) sum += (with[i] - bare[i]) * (with[i] - bare[i]);
  }
  return std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, o.rows())));
}

bool in_rig(Part part) {
  return part == Part::pose;
}
bool in_camera(Part part) {
  return part == Part::lens || part == Part::focal || part == Part::principal;
}

void upgrade_rig(const CloudsInput& input, const std::array<double, 6>& change, const std::array<double, 6>& sigma,
                 manifest::Document& document) {
  for (auto& [name, rig] : document.rigs)
    for (manifest::RigMember& member : rig.cameras) {
      if (member.camera != input.second) continue;
      Rigid<frame::Camera, frame::Camera> moved;
      moved.translation_m = {change[0], change[1], change[2]};
      moved.rotation = quaternion_of_rotation_vector({change[3], change[4], change[5]});
      static_cast<Rigid<frame::Rig, frame::Camera>&>(member.rig_from_camera) = member.rig_from_camera * moved;
      // One number for all axes: the change's axes are the device's, and the section's those of the rig.
      const double turn = std::max({sigma[3], sigma[4], sigma[5]}), shift = std::max({sigma[0], sigma[1], sigma[2]});
      member.rig_from_camera.sigma = manifest::PoseSigma{{turn}, {shift}};
    }
}

void upgrade_lens(const CloudsInput& input, const CloudParameters& declared, const Explanation& e,
                  std::span<const std::size_t> changed, std::size_t device, manifest::Document& document) {
  camera::Intrinsics lens = input.stations[device].lens.intrinsics();
  manifest::Camera& section = document.cameras.at(device == 0 ? input.first : input.second);
  camera::TermSet terms;
  for (const std::size_t p : changed) {
    const CloudRole& r = declared.roles[p];
    if (!in_camera(r.part) || r.device != device) continue;
    if (r.part == Part::lens) {
      lens.distortion[r.index] += e.values[p], terms.add(r.index);
      section.sigma[std::string(camera::distortion_names[r.index])] = {e.sigma[p]};
    } else if (r.part == Part::focal) {
      lens.fx_px *= 1 + e.values[p], lens.fy_px *= 1 + e.values[p];
      section.sigma["fx_px"] = {lens.fx_px * e.sigma[p]}, section.sigma["fy_px"] = {lens.fy_px * e.sigma[p]};
    } else {
      (r.index == 0 ? lens.cx_px : lens.cy_px) += e.values[p];
      section.sigma[r.index == 0 ? "cx_px" : "cy_px"] = {e.sigma[p]};
    }
  }
  if (lens == input.stations[device].lens.intrinsics()) return;
  section.model = camera::model_with(section.model, terms);
  camera::store(lens, section);
}

// One number a cell of the picture: the mean of its rows.
std::string map_svg(const CloudModel& model, const Observations& o, std::size_t view,
                    const std::vector<double>& residual, double scale) {
  const camera::CameraModel& lens = model.input().stations[0].lens;
  std::map<std::pair<std::size_t, std::size_t>, std::pair<double, double>> found;
  for (std::size_t i = 0; i < model.rows(view).size(); ++i) {
    const Vec2 pixel = model.rows(view)[i].pixel;
    const auto cell = [](double at, int size) {
      return static_cast<std::size_t>(std::clamp(at / size * cells, 0.0, cells - 1.0));
    };
    auto& [sum, count] = found[{cell(pixel.x, lens.width_px()), cell(pixel.y, lens.height_px())}];
    sum += residual[o.first[view] + i], ++count;
  }
  std::string svg = format(
      "<svg viewBox=\"0 0 %zu %zu\" role=\"img\" shape-rendering=\"crispEdges\" preserveAspectRatio=\"none\" "
      "style=\"background:#888;aspect-ratio:%d/%d;min-width:min(22rem,85vw)\">",
      cells, cells, lens.width_px(), lens.height_px());
  for (const auto& [at, cell] : found)
    svg += format("<rect x=\"%zu\" y=\"%zu\" width=\"1\" height=\"1\" fill=\"%s\"/>", at.first, at.second,
                  report::hex(report::signed_colour(cell.first / cell.second / scale)).c_str());
  return svg + "</svg>";
}

}  // namespace

std::string clouds_remarks(const Problem& problem, const CloudModel& model, const Explanation& e) {
  std::string text;
  const auto add = [&text](const std::string& sentence) { text += (text.empty() ? "" : " ") + sentence; };
  for (const std::size_t n : e.named) {
    const Candidate& c = problem.candidates()[n];
    const double effect = effect_of(problem, e, c);
    add(c.id() + " moves points by " + quantity(effect, "m", 2) + " (root mean square).");
    for (const Estimate& estimate : e.estimates)
      if (name_of(problem.parameters()[estimate.parameter]) == "depth_m")
        add("Points lie " + std::string(estimate.value > 0 ? "behind" : "before") +
            " the surface: light comes back from " + estimate_in_words(std::abs(estimate.value), estimate.sigma, "m") +
            (estimate.value > 0 ? " below it." : " above it."));
  }
  std::size_t asked = 0;
  for (std::size_t v = 0; v < model.input().views.size(); ++v) asked += model.rows(v).size();
  add(format("%zu points of %zu %s were asked, as many of each part of the picture.", asked, model.input().views.size(),
             model.input().against.empty() ? "clouds" : "overlaps"));
  return text;
}

void upgrade_clouds(const Problem& problem, const CloudsInput& input, const CloudParameters& declared,
                    const Explanation& e, manifest::Document& document) {
  std::vector<std::size_t> changed;
  for (const std::size_t n : e.named)
    for (const std::size_t p : problem.candidates()[n].parameters) changed.push_back(p);
  std::array<double, 6> change{}, sigma{};
  bool moved = false;
  for (const std::size_t p : changed)
    if (in_rig(declared.roles[p].part)) {
      moved = true;
      change[declared.roles[p].index] = e.values[p], sigma[declared.roles[p].index] = e.sigma[p];
    }
  if (moved) upgrade_rig(input, change, sigma, document);
  for (const std::size_t device : {0, 1}) upgrade_lens(input, declared, e, changed, device, document);
  const auto write = [&](const std::string& id, std::size_t p, const std::string& on) {
    manifest::MechanismUse& use = document.mechanisms[id];
    if (!on.empty() && std::ranges::find(use.on, on) == use.on.end()) use.on.push_back(on);
    const std::size_t place = on.empty() ? 0 : static_cast<std::size_t>(std::ranges::find(use.on, on) - use.on.begin());
    const std::string name = name_of(problem.parameters()[p]);
    std::vector<double>&value = use.parameters[name].value, &error = use.sigma[name];
    value.resize(std::max(value.size(), place + 1)), error.resize(value.size());
    value[place] = e.values[p], error[place] = e.sigma[p];
  };
  for (const std::size_t n : e.named) {
    const Candidate& c = problem.candidates()[n];
    for (const std::size_t p : c.parameters) {
      const CloudRole& r = declared.roles[p];
      if (in_rig(r.part) || in_camera(r.part)) continue;
      write(c.id(), p, r.part == Part::along ? input.clouds[r.index] : c.on.empty() ? "" : c.on[0]);
    }
  }
}

Illustration illustrate_clouds(const CloudModel& model, const Observations& o, const Explanation& e) {
  Illustration result;
  double sum = 0;
  for (const double r : e.residual_before) sum += r * r;
  const double scale = 2 * std::sqrt(sum / static_cast<double>(std::max<std::size_t>(1, e.residual_before.size())));
  const std::string of = model.input().against.empty() ? "shape" : "other cloud";
  for (std::size_t v = 0; v < std::min(most_drawn, model.input().views.size()); ++v) {
    const std::string& name = model.input().views[v].name;
    const std::string full = quantity(scale, "m", 2);
    result.pictures.push_back({name + ": how far points lie off the " + of + ", over the picture (red: behind it, " +
                                   full + " at full colour)",
                               "", map_svg(model, o, v, e.residual_before, scale)});
    if (!e.named.empty())
      result.pictures.push_back(
          {name + ": the same with the named physics", "", map_svg(model, o, v, e.residual_after, scale)});
  }
  return result;
}

}  // namespace gonio::explain
