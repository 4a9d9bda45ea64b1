// See outline_parameters.h.
#include "explain/outlines/outline_parameters.h"

#include <algorithm>
#include <array>

namespace gonio::mechanism {
const Mechanism& geometry_bend();
const Mechanism& geometry_offset();
const Mechanism& geometry_pose();
const Mechanism& geometry_scale();
const Mechanism& geometry_shrinkage();
const Mechanism& ground_not_flat();
const Mechanism& light_finite_size();
const Mechanism& light_position();
const Mechanism& mask_caustic();
}  // namespace gonio::mechanism

namespace gonio::explain {
namespace {

using alignment::Block;
using Part = OutlineRole::Part;
using Form = OutlineRole::Form;
using Groups = std::vector<std::size_t>;

constexpr double small_turn_rad = 1e-3, small_shift_m = 1e-4, small_share = 1e-3, small_blur_px = 0.1;
constexpr double usual_mask_px = 0.05;  // by which masks are too large or too small, all around
constexpr double sharpest_px = 0.35;    // of an edge between pixels that are squares, read between their middles

// What the words of a freedom are: "turn_x_rad", ...
std::vector<std::pair<std::string, std::string>> numbers_of(const alignment::Freedom& f) {
  const auto axes = [](const std::string& before, const std::string& after, const std::string& unit) {
    std::vector<std::pair<std::string, std::string>> names;
    for (const char* axis : {"x", "y", "z"}) names.emplace_back(before + axis + after, unit);
    return names;
  };
  switch (f.block) {
    case Block::body_turn:
    case Block::station_turn: return axes("turn_", "_rad", "rad");
    case Block::body_shift:
    case Block::station_shift:
    case Block::lamp_shift: return axes("shift_", "_m", "m");
    case Block::body_scale:
      return f.uniform ? decltype(axes("", "", "")){{"log_scale", "1"}} : axes("log_scale_", "", "1");
    case Block::lens_focal: return {{"log_focal", "1"}};
    default: return {};
  }
}

class Declaration {
 public:
  Declaration(const OutlinesInput& input, OutlineModel& model) : input_(input), in_(input.in), model_(model) {}

  OutlineParameters run() {
    for (const alignment::Freedom& f : in_.question.freedoms) base(f);
    for (std::size_t lens = 0; lens < in_.cameras.size(); ++lens) blur(lens);
    for (std::size_t g = 0; g < input_.views.size(); ++g) mask(g);
    for (std::size_t b = 0; b < in_.bodies.size(); ++b) of_body(b);
    of_lamps();
    of_ground();
    apart();
    return std::move(result_);
  }

 private:
  Groups groups_where(auto&& wanted) const {
    Groups groups;
    for (std::size_t g = 0; g < input_.views.size(); ++g)
      if (wanted(input_.views[g])) groups.push_back(g);
    return groups.size() == input_.views.size() ? Groups{} : groups;
  }
  Groups of_freedom(const alignment::Freedom& f) const {
    return groups_where([&](const OutlineView& v) {
      switch (f.block) {
        case Block::body_turn:
        case Block::body_shift:
        case Block::body_scale: return v.subject.body == f.which;
        case Block::lamp_shift: return v.subject.lamp == f.which;
        case Block::lens_focal: return in_.stated.stations[v.subject.station].lens == f.which;
        default: return v.subject.station == f.which;
      }
    });
  }
  std::string place_of(const alignment::Freedom& f) const {
    switch (f.block) {
      case Block::lamp_shift: return "lights/" + in_.lamps[f.which] + "/";
      case Block::lens_focal: return "cameras/" + in_.cameras[f.which] + "/";
      case Block::station_turn:
      case Block::station_shift: return "images/" + in_.images_of_station[f.which].front() + "/";
      default: return "objects/" + in_.bodies[f.which] + "/";
    }
  }
  std::size_t add(Parameter p, OutlineRole role) {
    result_.parameters.push_back(std::move(p)), model_.roles.push_back(role);
    return result_.parameters.size() - 1;
  }

  void base(const alignment::Freedom& f) {
    if (f.block == Block::ground_tilt || f.block == Block::ground_shift) return;
    model_.freedoms.push_back(f);
    std::size_t index = 0;
    for (const auto& [name, unit] : numbers_of(f)) {
      Parameter p;
      p.name = place_of(f) + name, p.unit = unit;
      p.size = unit == "rad" ? small_turn_rad : unit == "m" ? small_shift_m : small_share;
      p.groups = of_freedom(f);
      result_.base.push_back(add(std::move(p), {Part::freedom, model_.freedoms.size() - 1, f.which, index++}));
    }
  }
  void blur(std::size_t lens) {
    if (!(input_.blur_px[lens] > 0)) return;
    Parameter p;
    p.name = "cameras/" + in_.cameras[lens] + "/blur_px", p.unit = "px";
    p.start = p.neutral = input_.blur_px[lens];
    p.lower = sharpest_px, p.upper = 50, p.size = small_blur_px, p.prior_sigma = small_blur_px;
    p.groups = groups_where(
        [&](const OutlineView& v) { return v.subject.lamp && in_.stated.stations[v.subject.station].lens == lens; });
    result_.base.push_back(add(std::move(p), {Part::blur, 0, lens, 0}));
  }

  // What a mask is too large by all around.
  void mask(std::size_t group) {
    Parameter p;
    p.name = input_.views[group].name + "/mask_px", p.unit = "px";
    p.size = p.prior_sigma.emplace(usual_mask_px), p.groups = {group};
    result_.base.push_back(add(std::move(p), {Part::mask, 0, group, 0}));
  }

  Parameter parameter_of(const mechanism::Parameter& m, const std::string& before, Groups groups) const {
    Parameter p;
    p.name = before + m.name, p.unit = m.unit;
    p.start = m.start, p.neutral = m.neutral, p.lower = m.lower, p.upper = m.upper;
    p.size = m.typical > 0 ? of_typical * m.typical : small_share;
    p.groups = std::move(groups);
    return p;
  }
  Candidate of(const mechanism::Mechanism& m, std::vector<std::string> on) const {
    Candidate c;
    c.mechanism = &m, c.on = std::move(on);
    return c;
  }
  // Numbers of a freedom under the mechanism's own names.
  void by_freedom(Candidate& c, alignment::Freedom f, std::size_t from, Form form, const std::string& before = "") {
    model_.freedoms.push_back(f);
    for (std::size_t i = 0; i < f.size(); ++i)
      c.parameters.push_back(add(parameter_of(c.mechanism->parameters[from + i],
                                              before.empty() ? c.mechanism->id + "." : before, of_freedom(f)),
                                 {Part::freedom, model_.freedoms.size() - 1, f.which, i, form}));
  }
  void by_part(Candidate& c, Part part, std::size_t which, const Groups& groups) {
    for (std::size_t i = 0; i < c.mechanism->parameters.size(); ++i)
      c.parameters.push_back(
          add(parameter_of(c.mechanism->parameters[i], c.mechanism->id + ".", groups), {part, 0, which, i}));
  }
  void finish(Candidate c) { result_.candidates.push_back(std::move(c)); }

  bool is_free(Block block, std::size_t which) const {
    return std::any_of(in_.question.freedoms.begin(), in_.question.freedoms.end(),
                       [&](const alignment::Freedom& f) { return f.block == block && f.which == which; });
  }

  void of_body(std::size_t b) {
    const std::vector<std::string> on{in_.bodies[b]};
    const Groups groups = groups_where([&](const OutlineView& v) { return v.subject.body == b; });
    if (!is_free(Block::body_turn, b)) {
      Candidate c = of(mechanism::geometry_pose(), on);
      by_freedom(c, {Block::body_shift, b}, 0, Form::plain), by_freedom(c, {Block::body_turn, b}, 3, Form::plain);
      finish(std::move(c));
    }
    if (!is_free(Block::body_scale, b)) {
      Candidate c = of(mechanism::geometry_shrinkage(), on);
      by_freedom(c, {Block::body_scale, b}, 0, Form::shrinks);
      finish(std::move(c));
      c = of(mechanism::geometry_scale(), on);
      by_freedom(c, {Block::body_scale, b, 0, true}, 0, Form::grows);
      finish(std::move(c));
    }
    Candidate c = of(mechanism::geometry_bend(), on);
    by_part(c, Part::bend, b, groups);
    finish(std::move(c));
    c = of(mechanism::geometry_offset(), on);
    by_part(c, Part::offset, b, groups);
    finish(std::move(c));
  }

  void of_lamps() {
    Candidate moved = of(mechanism::light_position(), {}), large = of(mechanism::light_finite_size(), {});
    for (std::size_t l = 0; l < in_.lamps.size(); ++l) {
      const std::string before = in_.lamps[l] + "/";
      if (!is_free(Block::lamp_shift, l)) {
        moved.on.push_back(in_.lamps[l]);
        by_freedom(moved, {Block::lamp_shift, l}, 0, Form::plain, before);
      }
      if (input_.radii_m[l] != 0) continue;
      large.on.push_back(in_.lamps[l]);
      large.parameters.push_back(
          add(parameter_of(large.mechanism->parameters[0], before,
                           groups_where([&](const OutlineView& v) { return v.subject.lamp == l; })),
              {Part::radius, 0, l, 0}));
    }
    if (!moved.parameters.empty()) finish(std::move(moved));
    if (!large.parameters.empty()) finish(std::move(large));
  }

  void of_ground() {
    if (in_.ground.empty() || in_.lamps.empty()) return;
    Candidate c = of(mechanism::ground_not_flat(), {in_.ground});
    by_part(c, Part::ground, 0, groups_where([](const OutlineView& v) { return v.subject.lamp.has_value(); }));
    finish(std::move(c));
  }

  void apart() {
    if (in_.lamps.empty()) return;
    Candidate c = of(mechanism::mask_caustic(), {});
    for (std::size_t l = 0; l < in_.lamps.size(); ++l) {
      c.on.push_back(in_.lamps[l]);
      c.parameters.push_back(
          add(parameter_of(c.mechanism->parameters[0], in_.lamps[l] + "/", {}), {Part::apart, 0, l, 0}));
    }
    result_.lit_inside = result_.candidates.size();
    finish(std::move(c));
  }

  const OutlinesInput& input_;
  const alignment::AlignmentInput& in_;
  OutlineModel& model_;
  OutlineParameters result_;
};

}  // namespace

OutlineParameters outline_parameters(const OutlinesInput& input, OutlineModel& model) {
  return Declaration(input, model).run();
}

}  // namespace gonio::explain
