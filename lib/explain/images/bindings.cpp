#include "explain/images/bindings.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "base/error.h"
#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/surface.h"
#include "relighting/uses.h"

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
  Collector(const manifest::Document& document, const Recordings& recordings, const SceneLayout& layout,
            std::span<const Use> uses, std::size_t given)
      : document_(document), recordings_(recordings), layout_(layout), uses_(uses), given_(given) {}

  Bindings run() {
    surfaces();
    lights();
    for (std::size_t i = 0; i < recordings_.images.size(); ++i)
      each_free(recordings_.images[i].gain, {Kind::gain, i, 0, -1},
                {Origin::Section::images, recordings_.images[i].id, "gain", recordings_.images[i].entry, 0},
                "images/" + recordings_.images[i].id + "/gain", "1", {i}, 1e-6);
    for (std::size_t u = 0; u < uses_.size(); ++u) u < given_ ? given(uses_[u]) : candidate(uses_[u]);
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
                  "lights/" + name + "/" + key, key == "watt_per_sr" ? "W/sr" : "W/m^2", lit_by(recordings_, l), 0);
      }
    }
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

  // A free number of a mechanism that the manifest has switched on.
  void given(const Use& use) {
    const std::vector<mechanism::Parameter>& infos = use.mechanism->parameters;
    for (std::size_t i = 0; i < use.numbers.size(); ++i) {
      if (!use.numbers[i].free) continue;
      const std::string& key = infos[i % infos.size()].name;
      const manifest::Parameter& entry = document_.mechanisms.at(use.mechanism->id).parameters.at(key);
      Parameter p = searched(use, i);
      p.neutral = p.start;
      p.lower = entry.min.value_or(p.lower);
      p.upper = entry.max.value_or(p.upper);
      p.prior_sigma = entry.sigma;
      const Origin origin{Origin::Section::mechanisms, use.mechanism->id, key, 0,
                          entry.value.size() > 1 ? i / infos.size() : 0};
      out_.base.push_back(add(p, {{Kind::amount, use.place, i, -1}}, {origin}));
    }
  }

  void candidate(const Use& use) {
    Candidate candidate;
    candidate.mechanism = use.mechanism;
    candidate.on = use.on;
    candidate.family = use.family;
    candidate.finer = use.finer;
    candidate.gradual = use.term != nullptr && use.term->gradual;
    std::map<std::size_t, std::size_t> parameter_of;
    for (std::size_t i = 0; i < use.numbers.size(); ++i) {
      const Place place{Kind::amount, use.place, i, -1};
      if (const auto& same = use.numbers[i].same_as) {
        out_.places[parameter_of.at(*same)].push_back(place);
      } else if (use.numbers[i].free) {
        parameter_of[i] = add(searched(use, i), {place}, {});
        candidate.parameters.push_back(parameter_of[i]);
      }
    }
    if (candidate.parameters.empty()) return;
    if (use.term != nullptr && use.term->share_of_readings && use.sets == 1)
      candidate.share_of_readings = parameter_of.at(*use.term->share_of_readings);
    out_.candidates.push_back(std::move(candidate));
    out_.use_of.push_back(use.place);
  }

  static bool is_shared(const Use& use, std::size_t i) {
    return std::ranges::any_of(use.numbers, [i](const Number& n) { return n.same_as == i; });
  }

  static Parameter searched(const Use& use, std::size_t i) {
    const std::size_t n = use.mechanism->parameters.size();
    const mechanism::Parameter& info = use.mechanism->parameters[i % n];
    const Number& number = use.numbers[i];
    const bool one_target = use.on.size() == 1 || (use.sets > 1 && !is_shared(use, i));
    std::string target = one_target ? "@" + use.on[i / n] : "";
    if (!one_target && use.sets == 1 && !number.groups.empty())  // others may have numbers of their own
      for (const std::string& name : use.on) target += (target.empty() ? "@" : "+") + name;
    Parameter p;
    p.name = use.mechanism->id + target + "." + info.name;
    p.unit = info.unit;
    p.start = number.start;
    p.neutral = number.neutral;
    p.lower = number.lower;
    p.upper = number.upper;
    p.size =
        std::max({std::abs(number.start - number.neutral), 0.02 * std::min(number.upper - number.lower, 1e6), 1e-9});
    p.groups = number.groups;
    return p;
  }

  const manifest::Document& document_;
  const Recordings& recordings_;
  const SceneLayout& layout_;
  std::span<const Use> uses_;
  std::size_t given_;
  Bindings out_;
  std::map<std::string, std::size_t> shared_;
};

}  // namespace

double value_at(const SceneState& state, const Place& p) {
  switch (p.kind) {
    case Kind::surface: return get(state.surfaces[p.target].values.v[p.parameter], p.component);
    case Kind::intensity: return get(state.lights[p.target].intensity, p.component);
    case Kind::gain: return get(state.gain[p.target], p.component);
    case Kind::amount: return state.amounts[p.target][p.parameter];
  }
  return 0;
}

void set_value(SceneState& state, const Place& p, double value) {
  switch (p.kind) {
    case Kind::surface: return put(state.surfaces[p.target].values.v[p.parameter], p.component, value);
    case Kind::intensity: return put(state.lights[p.target].intensity, p.component, value);
    case Kind::gain: return put(state.gain[p.target], p.component, value);
    case Kind::amount: state.amounts[p.target][p.parameter] = value; return;
  }
}

void Bindings::set(SceneState& state, std::span<const double> values) const {
  for (std::size_t p = 0; p < places.size(); ++p)
    for (const Place& place : places[p]) set_value(state, place, values[p]);
}

Bindings bind_parameters(const manifest::Document& document, const Recordings& recordings, const SceneLayout& layout,
                         std::span<const Use> uses, std::size_t given) {
  return Collector(document, recordings, layout, uses, given).run();
}

}  // namespace gonio::explain::images
