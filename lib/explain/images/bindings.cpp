#include "explain/images/bindings.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"

namespace gonio::explain::images {
namespace {

using Kind = Place::Kind;

double& component_of(Rgb& rgb, int k) {
  return k == 0 ? rgb.x : k == 1 ? rgb.y : rgb.z;
}
const char* channel_name(std::size_t k) {
  return k == 0 ? "r" : k == 1 ? "g" : "b";
}

double get(const Rgb& rgb, int component) {
  return rgb[component < 0 ? 0 : component];
}
void put(Rgb& rgb, int component, double value) {
  if (component < 0)
    rgb = {value, value, value};
  else
    component_of(rgb, component) = value;
}

// Collects parameters; those that share a name become one.
class Collector {
 public:
  Collector(const manifest::Document& document, const Recordings& recordings, const SceneLayout& layout)
      : document_(document), recordings_(recordings), layout_(layout) {}

  Bindings run() {
    surfaces();
    lights();
    for (std::size_t i = 0; i < recordings_.images.size(); ++i)
      each_free(recordings_.images[i].gain, {Kind::gain, i, 0, -1},
                {Origin::Section::images, recordings_.images[i].id, "gain", recordings_.images[i].entry, 0},
                "images/" + recordings_.images[i].id + "/gain", "1", {i}, 1e-6);
    for (const mechanism::Mechanism* m : mechanism::all_mechanisms())
      if (std::find(m->domains.begin(), m->domains.end(), "images") != m->domains.end()) mechanism(*m);
    return std::move(out_);
  }

 private:
  void surfaces() {
    for (std::size_t s = 0; s < layout_.surfaces.size(); ++s) {
      const std::string& name = layout_.surfaces[s];
      const surface::Model& model = *layout_.start.surfaces[s].model;
      for (const auto& [key, parameter] : document_.surfaces.at(name).parameters) {
        if (!parameter.free) continue;
        const std::size_t index = parameter_index(model, key);
        const manifest::ParameterInfo& info = model.info().parameters[index];
        const std::size_t first = out_.parameters.size();
        each_free(parameter, {Kind::surface, s, index, -1}, {Origin::Section::surfaces, name, key, 0, 0},
                  "surfaces/" + name + "/" + key, info.unit, {}, info.lower);
        for (std::size_t p = first; p < out_.parameters.size(); ++p)
          out_.parameters[p].upper = std::min(out_.parameters[p].upper, info.upper);
      }
    }
  }

  void lights() {
    for (std::size_t l = 0; l < layout_.lights.size(); ++l) {
      const std::string& name = recordings_.lights[l];
      for (const auto& [key, parameter] : document_.lights.at(name).parameters) {
        if (!parameter.free) continue;
        if (key != "watt_per_sr" && key != "watt_per_m2")
          throw Error(Exit::data, manifest::place(document_, "/lights/" + name + "/" + key), "cannot be free on images",
                      "free the intensity; light.direction searches the place by itself");
        each_free(parameter, {Kind::intensity, l, 0, -1}, {Origin::Section::lights, name, key, 0, 0},
                  "lights/" + name + "/" + key, key == "watt_per_sr" ? "W/sr" : "W/m^2", lit_by(l), 0);
      }
    }
  }

  std::vector<std::size_t> lit_by(std::size_t light) const {
    std::vector<std::size_t> groups;
    for (std::size_t i = 0; i < recordings_.images.size(); ++i) {
      const std::vector<std::size_t>& lights = recordings_.images[i].lights;
      if (std::find(lights.begin(), lights.end(), light) != lights.end()) groups.push_back(i);
    }
    return groups.size() == recordings_.images.size() ? std::vector<std::size_t>{} : groups;
  }

  // Enters every component of a free manifest parameter.
  void each_free(const manifest::Parameter& parameter, Place place, Origin origin, const std::string& name,
                 const std::string& unit, const std::vector<std::size_t>& groups, double lower) {
    if (!parameter.free) return;
    const std::size_t count = parameter.value.size();
    for (std::size_t k = 0; k < count; ++k) {
      place.component = count == 1 ? -1 : static_cast<int>(k);
      origin.component = k;
      const std::string full = count == 1 ? name : name + "/" + channel_name(k);
      const std::string shared = parameter.share.empty() ? full : parameter.share + "/" + std::to_string(k);
      if (const auto known = shared_.find(shared); known != shared_.end()) {
        join(known->second, place, origin, groups);
        continue;
      }
      Parameter p;
      p.name = parameter.share.empty() ? full : count == 1 ? parameter.share : parameter.share + "/" + channel_name(k);
      p.unit = unit;
      p.start = p.neutral = parameter.value[k];
      p.lower = parameter.min.value_or(lower);
      if (parameter.max) p.upper = *parameter.max;
      p.size = std::max(0.1 * std::abs(p.start), 1e-3);
      p.prior_sigma = parameter.sigma;
      p.groups = groups;
      shared_[shared] = add(p, {place}, {origin});
      out_.base.push_back(shared_[shared]);
    }
  }

  void join(std::size_t parameter, const Place& place, const Origin& origin, const std::vector<std::size_t>& groups) {
    out_.places[parameter].push_back(place);
    out_.origins[parameter].push_back(origin);
    std::vector<std::size_t>& all = out_.parameters[parameter].groups;
    if (groups.empty())
      all.clear();
    else if (!all.empty())
      all.insert(all.end(), groups.begin(), groups.end());
    std::sort(all.begin(), all.end());
    all.erase(std::unique(all.begin(), all.end()), all.end());
    if (all.size() == recordings_.images.size()) all.clear();
  }

  std::size_t add(Parameter parameter, std::vector<Place> places, std::vector<Origin> origins) {
    out_.parameters.push_back(std::move(parameter));
    out_.places.push_back(std::move(places));
    out_.origins.push_back(std::move(origins));
    return out_.parameters.size() - 1;
  }

  // A parameter of a mechanism as a number of the search; nothing where the base model has the mechanism already.
  void enter(const mechanism::Mechanism& m, const mechanism::Parameter& info, std::vector<Place> places,
             const std::string& target, const std::vector<std::size_t>& groups, Candidate& candidate) {
    Parameter p;
    p.name = m.id + (target.empty() ? "" : "@" + target) + "." + info.name;
    p.unit = info.unit;
    p.start = info.start;
    p.neutral = info.neutral;
    p.lower = info.lower;
    p.upper = info.upper;
    p.size = std::max({std::abs(info.start - info.neutral), 0.02 * (info.upper - info.lower), 1e-9});
    p.groups = groups;
    candidate.parameters.push_back(add(p, std::move(places), {}));
  }

  void mechanism(const mechanism::Mechanism& m) {
    Candidate candidate;
    candidate.mechanism = &m;
    if (m.target == mechanism::Target::surface) {
      for (std::size_t s = 0; s < layout_.surfaces.size(); ++s) of_surface(m, s);
    } else if (m.id == "light.finite-size") {
      of_lamp_size(m, candidate);
    } else if (m.id == "light.direction") {
      of_direction(m, candidate);
    } else if (m.id == "light.ambient") {
      if (max_component(layout_.start.ambient) > 0) return;
      for (std::size_t k = 0; k < m.parameters.size(); ++k)
        enter(m, m.parameters[k], {{Kind::ambient, 0, 0, static_cast<int>(k)}}, "", {}, candidate);
    } else if (m.id == "optics.vignetting") {
      if (layout_.start.falloff != 0) return;
      enter(m, m.parameters[0], {{Kind::falloff, 0, 0, -1}}, "", {}, candidate);
    } else if (m.id == "transport.indirect") {
      if (layout_.start.indirect != 0) return;
      enter(m, m.parameters[0], {{Kind::indirect, 0, 0, -1}}, "", {}, candidate);
    }
    if (!candidate.parameters.empty()) out_.candidates.push_back(std::move(candidate));
  }

  void of_surface(const mechanism::Mechanism& m, std::size_t s) {
    const SurfaceState& surface = layout_.start.surfaces[s];
    for (const mechanism::Parameter& info : m.parameters)
      if (!has_parameter(*surface.model, info.name)) return;
    const double first = surface.values.scalar(parameter_index(*surface.model, m.parameters[0].name));
    if (first != m.parameters[0].neutral) return;
    Candidate candidate;
    candidate.mechanism = &m;
    candidate.on = {layout_.surfaces[s]};
    for (const mechanism::Parameter& info : m.parameters)
      enter(m, info, {{Kind::surface, s, parameter_index(*surface.model, info.name), -1}}, layout_.surfaces[s], {},
            candidate);
    out_.candidates.push_back(std::move(candidate));
  }

  void of_lamp_size(const mechanism::Mechanism& m, Candidate& candidate) {
    std::vector<Place> places;
    for (std::size_t l = 0; l < layout_.lights.size(); ++l) {
      if (layout_.lights[l].directional || layout_.start.lights[l].radius_m > 0) continue;
      places.push_back({Kind::radius, l, 0, -1});
      candidate.on.push_back(recordings_.lights[l]);
    }
    if (places.empty()) return;
    enter(m, m.parameters[0], places, "", {}, candidate);
    Parameter& radius = out_.parameters[candidate.parameters[0]];
    radius.upper = std::min(radius.upper, radii_m.back());
  }

  void of_direction(const mechanism::Mechanism& m, Candidate& candidate) {
    for (std::size_t l = 0; l < layout_.lights.size(); ++l) {
      const LightState& light = layout_.start.lights[l];
      if (light.tilt_x_rad != 0 || light.tilt_y_rad != 0) continue;
      candidate.on.push_back(recordings_.lights[l]);
      enter(m, m.parameters[0], {{Kind::tilt_x, l, 0, -1}}, recordings_.lights[l], lit_by(l), candidate);
      enter(m, m.parameters[1], {{Kind::tilt_y, l, 0, -1}}, recordings_.lights[l], lit_by(l), candidate);
    }
  }

  const manifest::Document& document_;
  const Recordings& recordings_;
  const SceneLayout& layout_;
  Bindings out_;
  std::map<std::string, std::size_t> shared_;
};

}  // namespace

double value_at(const SceneState& state, const Place& p) {
  switch (p.kind) {
    case Kind::surface: return get(state.surfaces[p.target].values.v[p.parameter], p.component);
    case Kind::intensity: return get(state.lights[p.target].intensity, p.component);
    case Kind::radius: return state.lights[p.target].radius_m;
    case Kind::tilt_x: return state.lights[p.target].tilt_x_rad;
    case Kind::tilt_y: return state.lights[p.target].tilt_y_rad;
    case Kind::ambient: return get(state.ambient, p.component);
    case Kind::falloff: return state.falloff;
    case Kind::indirect: return state.indirect;
    case Kind::gain: return get(state.gain[p.target], p.component);
  }
  return 0;
}

void set_value(SceneState& state, const Place& p, double value) {
  switch (p.kind) {
    case Kind::surface: return put(state.surfaces[p.target].values.v[p.parameter], p.component, value);
    case Kind::intensity: return put(state.lights[p.target].intensity, p.component, value);
    case Kind::radius: state.lights[p.target].radius_m = value; return;
    case Kind::tilt_x: state.lights[p.target].tilt_x_rad = value; return;
    case Kind::tilt_y: state.lights[p.target].tilt_y_rad = value; return;
    case Kind::ambient: return put(state.ambient, p.component, value);
    case Kind::falloff: state.falloff = value; return;
    case Kind::indirect: state.indirect = value; return;
    case Kind::gain: return put(state.gain[p.target], p.component, value);
  }
}

void Bindings::set(SceneState& state, std::span<const double> values) const {
  for (std::size_t p = 0; p < places.size(); ++p)
    for (const Place& place : places[p]) set_value(state, place, values[p]);
}

Bindings bind_parameters(const manifest::Document& document, const Recordings& recordings, const SceneLayout& layout) {
  return Collector(document, recordings, layout).run();
}

}  // namespace gonio::explain::images
