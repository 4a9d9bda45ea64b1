// See lamp_state.h.
#include "explain/tables/lamp_state.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "base/error.h"
#include "light/irradiance.h"
#include "light/mechanisms/light_lobe.h"
#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& light_position();
const Mechanism& light_second_source();
}  // namespace gonio::mechanism

namespace gonio::explain::tables {
namespace {

constexpr int grid = 12;

scene::Light lamp_of(const manifest::Document& document, const std::string& name, const std::string& place) {
  const auto found = document.lights.find(name);
  if (found == document.lights.end())
    throw Error(Exit::data, place, "names light \"" + name + "\", which is not there");
  const manifest::Light& section = found->second;
  scene::Light lamp;
  lamp.id = name;
  lamp.model = light::find(section.model);
  lamp.parameters = section.parameters;
  const std::string at = manifest::place(document, "/lights/" + name);
  if (lamp.model->info().attachment == manifest::Attachment::picture)
    throw Error(Exit::data, at, "shines through a picture, which a table of irradiances does not read",
                "explain images of it instead");
  if (!section.file.empty()) lamp.file = manifest::resolve(document, section.file, "/lights/" + name + "/file");
  scene::refresh(lamp, at);
  return lamp;
}

const std::vector<double>* given(const scene::Light& lamp, const std::string& name) {
  const auto found = lamp.parameters.find(name);
  return found == lamp.parameters.end() || !found->second.given() ? nullptr : &found->second.value;
}

std::vector<double> list_of(Vec3 v) {
  return {v.x, v.y, v.z};
}

}  // namespace

LampLight::LampLight(const scene::Light& lamp) : lamp_(lamp) {
  const std::string& model = lamp.model->info().id;
  small_ = model == "point" || model == "sphere";
  if (!small_) return;
  intensity_ = lamp.parameters.at("watt_per_sr").rgb();
  position_m_ = lamp.parameters.at("position_m").vector();
  if (const std::vector<double>* radius = given(lamp, "radius_m")) radius_m_ = radius->at(0);
}

Rgb LampLight::irradiance(Vec3 point_m, Vec3 normal) const {
  if (small_)
    return radius_m_ == 0 ? light::point_irradiance(intensity_, position_m_, point_m, normal)
                          : light::sphere_irradiance(intensity_, position_m_, radius_m_, point_m, normal);
  Rgb sum;
  for (int i = 0; i < grid * grid; ++i) {
    const light::Sample s = lamp_.emitter->sample(point_m, {(i % grid + 0.5) / grid, (i / grid + 0.5) / grid});
    if (s.valid) sum = sum + s.weight * std::max(0.0, dot(s.direction, normal));
    if (s.valid && s.delta) return sum * (1.0 / (i + 1));
  }
  return sum * (1.0 / (grid * grid));
}

Sight sight_of(const scene::Light& lamp, Vec3 point_m, Vec3 centre_m) {
  Sight sight;
  if (const std::vector<double>* position = given(lamp, "position_m"); position != nullptr) {
    const Vec3 at{(*position)[0], (*position)[1], (*position)[2]}, arm = at - point_m;
    sight.distance_m = norm(arm);
    sight.towards = sight.distance_m > 0 ? arm * (1 / sight.distance_m) : Vec3{0, 0, 1};
    const std::vector<double>* axis = given(lamp, "direction");
    const Vec3 facing = axis != nullptr ? Vec3{(*axis)[0], (*axis)[1], (*axis)[2]} : centre_m - at;
    if (norm(facing) > 0)
      sight.emission_rad = std::acos(std::clamp(-dot(normalized(facing), sight.towards), -1.0, 1.0));
    return sight;
  }
  const std::vector<double>* towards = given(lamp, "towards");
  sight.towards = towards == nullptr ? Vec3{0, 0, 1} : normalized(Vec3{(*towards)[0], (*towards)[1], (*towards)[2]});
  sight.distance_m = -dot(point_m - centre_m, sight.towards);
  return sight;
}

LampState::LampState(const manifest::Document& document, const std::vector<std::string>& names, Vec3 centre_m,
                     std::span<const Vec3> points_m, const std::string& place)
    : centre_m_(centre_m), place_(place) {
  for (const std::string& name : names) appearance_.lights.push_back(lamp_of(document, name, place));
  free_parameters(document);
  mechanisms_of_lamps(points_m);
  second_source();
}

void LampState::add(Parameter parameter, LampNumber number) {
  parameters_.push_back(std::move(parameter));
  numbers_.push_back(std::move(number));
}

void LampState::free_parameters(const manifest::Document&) {
  constexpr char axes[] = "xyz";
  for (std::size_t l = 0; l < lamps().size(); ++l)
    for (const auto& [name, value] : lamps()[l].parameters) {
      if (!value.free) continue;
      for (std::size_t k = 0; k < value.value.size(); ++k) {
        Parameter p;
        p.name = "lights/" + lamps()[l].id + "/" + name + (value.value.size() > 1 ? std::string("_") + axes[k] : "");
        p.start = p.neutral = value.value[k];
        for (const manifest::ParameterInfo& info : lamps()[l].model->info().parameters)
          if (info.name == name) p.lower = info.lower, p.upper = info.upper;
        if (value.min) p.lower = std::max(p.lower, *value.min);
        if (value.max) p.upper = std::min(p.upper, *value.max);
        p.prior_sigma = value.sigma;
        double largest = 0;
        for (const double v : value.value) largest = std::max(largest, std::abs(v));
        p.size = largest > 0 ? largest : 1;
        base_.push_back(parameters_.size());
        add(std::move(p), {l, name, nullptr, k});
      }
    }
}

// Every registered mechanism of lamps that tables show and that the scene can apply to this one.
void LampState::mechanisms_of_lamps(std::span<const Vec3> points_m) {
  for (const mechanism::Mechanism* m : mechanism::all_mechanisms()) {
    if (m->target != mechanism::Target::light) continue;
    if (std::find(m->domains.begin(), m->domains.end(), "tables") == m->domains.end()) continue;
    if (m->id == mechanism::light_position().id) continue;  // places of lamps are the base model's own parameters here
    const std::vector<std::string> targets = scene::mechanism_targets(appearance_, *m);
    for (std::size_t l = 0; l < lamps().size(); ++l) {
      if (std::find(targets.begin(), targets.end(), lamps()[l].id) == targets.end()) continue;
      std::vector<std::size_t> all;
      for (std::size_t k = 0; k < m->parameters.size(); ++k) all.push_back(k);
      if (m->id != mechanism::light_lobe().id)
        form_of_lamp(*m, l, all, {});
      else
        lobes_of_lamp(l, points_m);
    }
  }
}

void LampState::form_of_lamp(const mechanism::Mechanism& m, std::size_t lamp, std::span<const std::size_t> numbers,
                             const std::string& form) {
  Candidate candidate{&m, {lamps()[lamp].id}, {}, m.id + " " + lamps()[lamp].id};
  for (const std::size_t k : numbers) {
    const mechanism::Parameter& p = m.parameters[k];
    candidate.parameters.push_back(parameters_.size());
    const double size =
        std::max(std::min(std::abs(p.start - p.neutral), p.upper - p.lower), 0.02 * (p.upper - p.lower));
    add({lamps()[lamp].id + form + "/" + p.name, p.unit, p.start, p.neutral, p.lower, p.upper, size, {}, {}},
        {lamp, "", &m, k});
  }
  candidates_.push_back(std::move(candidate));
}

// A lamp that fades, or one with a cone, whose edge is sought from where the outermost points lie.
void LampState::lobes_of_lamp(std::size_t lamp, std::span<const Vec3> points_m) {
  const mechanism::Mechanism& m = mechanism::light_lobe();
  double widest = 0;
  for (const Vec3& p : points_m) widest = std::max(widest, sight_of(lamps()[lamp], p, centre_m_).emission_rad);
  const std::size_t fading[] = {mechanism::lobe_exponent}, cone[] = {mechanism::lobe_outer, mechanism::lobe_inner};
  form_of_lamp(m, lamp, fading, "");
  if (!(widest > 0)) return;
  const std::size_t aimed[] = {mechanism::lobe_outer, mechanism::lobe_inner, mechanism::lobe_tilt_x,
                               mechanism::lobe_tilt_y};
  for (const auto& [numbers, form] : {std::pair{std::span<const std::size_t>(cone), " with a cone"},
                                      std::pair{std::span<const std::size_t>(aimed), " with an aimed cone"}}) {
    form_of_lamp(m, lamp, numbers, form);
    Parameter& outer = parameters_[candidates_.back().parameters[0]];
    outer.start = std::clamp(0.95 * widest, outer.lower, outer.upper);
  }
}

void LampState::second_source() {
  const mechanism::Mechanism* m = &mechanism::light_second_source();  // irradiance, azimuth, elevation
  double facing = 0;
  for (const scene::Light& lamp : lamps()) {
    const Rgb e = LampLight(lamp).irradiance(centre_m_, sight_of(lamp, centre_m_, centre_m_).towards);
    facing = std::max(facing, e.x);
  }
  if (!(facing > 0)) return;
  for (int quarter = 0; quarter < 4; ++quarter) {
    const double azimuth = 0.5 * pi * quarter;
    Candidate candidate{m, {}, {}, m->id};
    const std::array<Parameter, 3> own = {
        Parameter{"", m->parameters[0].unit, 0.05 * facing, 0, 0, facing, 0.05 * facing, {}, {}},
        Parameter{"", "rad", azimuth, azimuth, azimuth - 0.3 * pi, azimuth + 0.3 * pi, 0.5, {}, {}},
        Parameter{"", "rad", 0.8, 0.8, 0.05, 1.5, 0.3, {}, {}}};
    for (std::size_t k = 0; k < 3; ++k) {
      candidate.parameters.push_back(parameters_.size());
      Parameter p = own[k];
      p.name = m->id + "-" + std::to_string(quarter + 1) + "/" + m->parameters[k].name;
      add(std::move(p), {lamps().size(), "", m, k});
    }
    candidates_.push_back(std::move(candidate));
  }
}

scene::Light LampState::second_lamp(std::span<const double> numbers) const {
  const double around = numbers[1], up = numbers[2];
  const Vec3 towards{std::cos(up) * std::cos(around), std::cos(up) * std::sin(around), std::sin(up)};
  scene::Light lamp;
  lamp.id = "second source";
  const Sight first = sight_of(lamps()[0], centre_m_, centre_m_);
  if (given(lamps()[0], "position_m") != nullptr && first.distance_m > 0) {
    lamp.model = light::find("point");
    lamp.parameters = {{"position_m", manifest::Parameter(list_of(centre_m_ + towards * first.distance_m))},
                       {"watt_per_sr", manifest::Parameter(numbers[0] * first.distance_m * first.distance_m)}};
  } else {
    lamp.model = light::find("directional");
    lamp.parameters = {{"towards", manifest::Parameter(list_of(towards))},
                       {"watt_per_m2", manifest::Parameter(numbers[0])}};
  }
  scene::refresh(lamp, place_);
  return lamp;
}

std::vector<scene::Light> LampState::at(std::span<const double> values) const {
  scene::Appearance state = appearance_;
  std::vector<char> changed(state.lights.size(), 0);
  std::optional<scene::Light> second;
  for (const std::size_t p : base_) {
    const LampNumber& n = numbers_[p];
    state.lights[n.lamp].parameters[n.name].value[n.component] = values[p];
    changed[n.lamp] = 1;
  }
  for (std::size_t l = 0; l < changed.size(); ++l)
    if (changed[l]) scene::refresh(state.lights[l], place_);
  for (const Candidate& c : candidates_) {
    const mechanism::Mechanism& m = *c.mechanism;
    const std::size_t lamp = numbers_[c.parameters[0]].lamp;
    manifest::MechanismUse use;
    use.on = c.on;
    bool in_play = false;
    for (std::size_t k = 0; k < c.parameters.size(); ++k) {
      const double v = values[c.parameters[k]];
      use.parameters[m.parameters[numbers_[c.parameters[k]].component].name] = v;
      in_play = in_play || v != parameters_[c.parameters[k]].neutral;
    }
    if (!in_play) continue;
    if (lamp == lamps().size()) {
      second =
          second_lamp(std::vector<double>{values[c.parameters[0]], values[c.parameters[1]], values[c.parameters[2]]});
      continue;
    }
    scene::apply_mechanism(state, m, use, centre_m_, place_);
  }
  if (second) state.lights.push_back(std::move(*second));
  return state.lights;
}

void LampState::apply(std::span<const double> values, std::span<const double> sigma,
                      manifest::Document& document) const {
  for (const std::size_t p : base_) {
    const LampNumber& n = numbers_[p];
    manifest::Light& light = document.lights.at(lamps()[n.lamp].id);
    std::vector<double>& value = light.parameters[n.name].value;
    value[n.component] = values[p];
    std::vector<double>& width = light.sigma[n.name];
    width.resize(value.size(), 0);
    width[n.component] = sigma[p];
  }
}

}  // namespace gonio::explain::tables
