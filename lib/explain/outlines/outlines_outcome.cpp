// See outlines_outcome.h.
#include "explain/outlines/outlines_outcome.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/text.h"
#include "inference/apart.h"
#include "inference/wording.h"
#include "manifest/document.h"
#include "manifest/pose_sigma.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/object.h"
#include "report/colour_map.h"
#include "stats/distributions.h"

namespace gonio::explain {
namespace {

using alignment::Block;
using Part = OutlineRole::Part;

constexpr std::size_t most_drawn = 4;
constexpr double least_share = 0.02;  // of a lamp's rims, that run around lit parts

// Of a freedom's numbers in e.active; nothing where they are held.
std::optional<std::size_t> active_place(const OutlineModel& model, const Explanation& e, Block block, std::size_t which,
                                        std::size_t index) {
  for (std::size_t k = 0; k < e.active.size(); ++k) {
    const OutlineRole& r = model.roles[e.active[k]];
    if (r.part == Part::freedom && model.freedoms[r.freedom].block == block &&
        model.freedoms[r.freedom].which == which && r.index == index)
      return k;
  }
  return {};
}

double covariance_of(const Explanation& e, std::optional<std::size_t> a, std::optional<std::size_t> b) {
  return a && b ? e.covariance[*a * e.active.size() + *b] : 0;
}

// Is one growth along all axes named for this body?
bool grown(const OutlineModel& model, const Explanation& e, std::size_t body) {
  return std::any_of(e.active.begin(), e.active.end(), [&](std::size_t p) {
    const OutlineRole& r = model.roles[p];
    return r.part == Part::freedom && r.form == OutlineRole::Form::grows && r.which == body;
  });
}

void move_objects(const OutlineModel& model, const OutlinesInput& input, const Explanation& e,
                  const alignment::Setting& setting, manifest::Document& document) {
  for (manifest::Object& object : document.objects) {
    const auto at = std::find(input.in.bodies.begin(), input.in.bodies.end(), object.id);
    if (at == input.in.bodies.end()) continue;
    const auto b = static_cast<std::size_t>(at - input.in.bodies.begin());
    std::array<std::optional<std::size_t>, 6> places;
    for (std::size_t i = 0; i < 6; ++i)
      places[i] = active_place(model, e, i < 3 ? Block::body_turn : Block::body_shift, b, i % 3);
    if (std::none_of(places.begin(), places.end(), [](const auto& p) { return p.has_value(); })) continue;
    std::array<double, 36> covariance{};
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t k = 0; k < 6; ++k) covariance[6 * i + k] = covariance_of(e, places[i], places[k]);
    const alignment::Body& body = setting.bodies[b];
    object.world_from_object.emplace();
    object.world_from_object->rotation = body.world_from_object.rotation;
    object.world_from_object->translation_m = body.world_from_object.translation_m;
    if (grown(model, e, b)) {  // geometry.scale is about the object's origin, and the fit's about the middle of its box
      const Vec3 c = body.shape->centre_m(), before = input.in.stated.bodies[b].scale;
      const double factor = body.scale.x / before.x;
      object.world_from_object->translation_m += body.world_from_object.rotate(c * (1 - factor));
    }
    object.world_from_object->sigma = manifest::sigma_at(std::span<const double, 36>(covariance),
                                                         body.world_from_object.translation_m - body.centre_m());
  }
}

void move_lamps(const OutlineModel& model, const OutlinesInput& input, const Explanation& e,
                const alignment::Setting& setting, manifest::Document& document) {
  for (std::size_t l = 0; l < input.in.lamps.size(); ++l) {
    std::array<std::optional<std::size_t>, 3> places;
    for (std::size_t i = 0; i < 3; ++i) places[i] = active_place(model, e, Block::lamp_shift, l, i);
    if (!places[0] && !places[1] && !places[2]) continue;
    manifest::Light& light = document.lights.at(input.in.lamps[l]);
    const Vec3 at = setting.lamps_m[l];
    light.parameters["position_m"].value = {at.x, at.y, at.z};
    std::vector<double> sigma;
    for (const auto& p : places) sigma.push_back(std::sqrt(std::max(0.0, covariance_of(e, p, p))));
    light.sigma["position_m"] = sigma;
  }
}

// What the manifest says already, and what is named beyond it, as one.
void write_scale(const OutlineModel& model, const OutlinesInput& input, const alignment::Setting& setting,
                 const Explanation& e, const Candidate& c, manifest::Document& document) {
  const auto body = static_cast<std::size_t>(std::find(input.in.bodies.begin(), input.in.bodies.end(), c.on[0]) -
                                             input.in.bodies.begin());
  const Vec3 scale = setting.bodies[body].scale, stated = input.in.stated.bodies[body].scale;
  const std::array<double, 3> all{scale.x, scale.y, scale.z}, before{stated.x, stated.y, stated.z};
  manifest::MechanismUse& use = document.mechanisms[c.id()];
  use.on = c.on;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::string& name = c.mechanism->parameters[k].name;
    use.parameters[name] = 1 - all[k];
    double sigma = 0;
    for (const std::size_t p : c.parameters)
      if (model.roles[p].index == k) sigma = before[k] * e.sigma[p];
    use.sigma[name] = {sigma};
  }
}

void write_named(const Problem& problem, const OutlineModel& model, const Explanation& e, const Candidate& c,
                 manifest::Document& document) {
  manifest::MechanismUse& use = document.mechanisms[c.id()];
  use.on = c.on;
  for (const std::size_t p : c.parameters) {
    const std::string& full = problem.parameters()[p].name;
    const std::string name = full.substr(full.find_last_of("./") + 1);
    const bool each = model.roles[p].part == Part::radius || model.roles[p].part == Part::apart;
    const std::size_t place =
        each ? static_cast<std::size_t>(std::find(c.on.begin(), c.on.end(), full.substr(0, full.find_last_of('/'))) -
                                        c.on.begin())
             : 0;
    std::vector<double>&value = use.parameters[name].value, &sigma = use.sigma[name];
    value.resize(each ? c.on.size() : 1), sigma.resize(value.size());
    value[place] = e.values[p], sigma[place] = e.sigma[p];
  }
}

std::string rim_svg(const OutlinesInput& input, const OutlineView& view, std::span<const double> residual,
                    double scale) {
  const auto& lens = input.in.models[input.in.stated.stations[view.subject.station].lens];
  std::string svg =
      format("<svg viewBox=\"0 0 %d %d\" role=\"img\" style=\"background:#888;min-width:min(22rem,85vw)\">",
             lens.width_px(), lens.height_px());
  const double radius = std::max(1.0, lens.width_px() / 250.0);
  for (std::size_t i = 0; i < view.rows.size(); ++i)
    if (!view.rows[i].width)
      svg +=
          format("<circle cx=\"%.2f\" cy=\"%.2f\" r=\"%.2f\" fill=\"%s\"/>", view.rows[i].pixel.x + 0.5,
                 view.rows[i].pixel.y + 0.5, radius, report::hex(report::signed_colour(residual[i] / scale)).c_str());
  return svg + "</svg>";
}

}  // namespace

Change change_by(const Problem& problem, const OutlinesInput& input, const Explanation& e, std::size_t candidate) {
  std::vector<double> without = e.values;
  for (const std::size_t p : problem.candidates()[candidate].parameters) without[p] = problem.parameters()[p].neutral;
  const Observations& o = problem.observations();
  std::array<double, 2> sum{}, count{};
  for (std::size_t g = 0; g < o.groups(); ++g) {
    std::vector<double> with(o.first[g + 1] - o.first[g]), bare(with.size());
    problem.predict(e.values, g, with), problem.predict(without, g, bare);
    for (std::size_t i = 0; i < with.size(); ++i) {
      const bool width = input.views[g].rows[i].width;
      sum[width] += (with[i] - bare[i]) * (with[i] - bare[i]), count[width] += 1;
    }
  }
  return {std::sqrt(sum[0] / std::max(1.0, count[0])), std::sqrt(sum[1] / std::max(1.0, count[1]))};
}

std::string outlines_remarks(const Problem& problem, const OutlinesInput& input, const Explanation& e) {
  std::size_t offsets = 0, widths = 0;
  for (const OutlineView& v : input.views)
    for (const OutlineRow& r : v.rows) ++(r.width ? widths : offsets);
  std::string text = format("%zu points of %zu rims were asked, and the widths of shadows' edges at %zu of them.",
                            offsets, input.views.size(), widths);
  for (const std::size_t n : e.named) {
    const Candidate& c = problem.candidates()[n];
    if (c.parameters.empty()) continue;
    const Change change = change_by(problem, input, e, n);
    if (change.offset_px > 0)
      text += " " + c.id() + " moves rims by " + quantity(change.offset_px, "px") + " (root mean square).";
    if (change.width_px > 0)
      text += " " + c.id() + " widens shadows' edges by " + quantity(change.width_px, "px") + " (root mean square).";
  }
  return text;
}

void upgrade_outlines(const Problem& problem, const OutlineModel& model, const OutlinesInput& input,
                      const Explanation& e, manifest::Document& document) {
  const alignment::Setting setting = model.setting(e.values);
  move_objects(model, input, e, setting, document);
  move_lamps(model, input, e, setting, document);
  for (const std::size_t n : e.named) {
    const Candidate& c = problem.candidates()[n];
    if (c.parameters.empty()) continue;
    const OutlineRole& r = model.roles[c.parameters[0]];
    if (r.part != Part::freedom)
      write_named(problem, model, e, c, document);
    else if (model.freedoms[r.freedom].block == Block::body_scale && !model.freedoms[r.freedom].uniform)
      write_scale(model, input, setting, e, c, document);
    else if (model.freedoms[r.freedom].block == Block::body_scale)
      write_named(problem, model, e, c, document);
  }
}

Illustration illustrate_outlines(const OutlinesInput& input, const Observations& o, const Explanation& e) {
  Illustration result;
  if (e.residual_before.size() != o.rows()) return result;
  std::vector<std::pair<double, std::size_t>> worst;
  for (std::size_t g = 0; g < o.groups(); ++g) {
    double sum = 0;
    for (std::size_t i = o.first[g]; i < o.first[g + 1]; ++i) sum += e.residual_before[i] * e.residual_before[i];
    worst.emplace_back(sum / static_cast<double>(o.first[g + 1] - o.first[g]), g);
  }
  std::sort(worst.rbegin(), worst.rend());
  const double scale = std::max(1e-3, 2 * std::sqrt(worst.front().first));
  for (std::size_t k = 0; k < std::min(most_drawn, worst.size()); ++k) {
    const std::size_t g = worst[k].second;
    const auto part = [&](const std::vector<double>& all) {
      return std::span(all).subspan(o.first[g], o.first[g + 1] - o.first[g]);
    };
    result.pictures.push_back({input.views[g].name + ": how far the rim lies outside of the model's (red: outside, " +
                                   quantity(scale, "px") + " at full colour)",
                               "", rim_svg(input, input.views[g], part(e.residual_before), scale)});
    if (!e.named.empty())
      result.pictures.push_back({input.views[g].name + ": the same with the named physics", "",
                                 rim_svg(input, input.views[g], part(e.residual_after), scale)});
  }
  return result;
}

void conclude_lit(const Problem& problem, const OutlinesInput& input, std::size_t candidate, Explanation& e) {
  const Candidate& c = problem.candidates()[candidate];
  inference::Apart apart{.candidate = candidate, .estimates = {}};
  std::size_t inside = 0, outside = 0, points = 0, lit = 0;
  for (const LitInside& l : input.lit) {
    inside += l.stretches_inside, outside += l.stretches_outside, points += l.points, lit += l.inside;
    if (l.points == 0) continue;
    // By stretches of rim, not by points: neighbours are lit together.
    const double share = static_cast<double>(l.inside) / static_cast<double>(l.points);
    const double stretches = std::max(1.0, share > 0 ? static_cast<double>(l.stretches_inside) / share : 1.0);
    const double sigma = std::sqrt(std::max(share, 1 / stretches) * (1 - std::min(share, 0.99)) / stretches);
    const std::size_t p = c.parameters[l.lamp];
    apart.estimates.push_back(
        {p, share, sigma, std::max(0.0, share - 1.96 * sigma), std::min(1.0, share + 1.96 * sigma), false});
    e.values[p] = share, e.sigma[p] = sigma;
  }
  if (points == 0) return;
  const double share = static_cast<double>(lit) / static_cast<double>(points);
  apart.p = stats::binomial_upper(static_cast<int>(inside), static_cast<int>(inside + outside), 0.5);
  apart.effect = share;
  apart.with = apart.without = e.held_out_after;
  if (share < least_share)
    apart.refused = "less than " + format("%.0f %%", 100 * least_share) + " of the shadows' rims";
  inference::join(problem, apart, e);
}

}  // namespace gonio::explain
