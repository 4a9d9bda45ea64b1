#include "explain/images/scene_state.h"

#include <algorithm>

#include "base/error.h"
#include "light/light.h"
#include "light/turn.h"

namespace gonio::explain::images {
namespace {

SurfaceState surface_state(const manifest::Document& document, const std::string& name) {
  const manifest::Surface& entry = document.surfaces.at(name);
  const std::string place = manifest::place(document, "/surfaces/" + name);
  if (!entry.textures.empty())
    throw Error(Exit::data, place, "has a texture, which explain cannot refit", "give a uniform value");
  const surface::Model* own = surface::find(entry.model);
  if (!own) throw Error(Exit::data, place, "has the unknown model \"" + entry.model + "\"", "see gonio-manifest(5)");
  const surface::Values values = surface::values_of(*own, entry.parameters, place);
  if (entry.model != "diffuse") return {own, values};
  SurfaceState state{surface::find("coated-diffuse"), {}};
  for (std::size_t i = 0; i < state.model->info().parameters.size(); ++i) {
    const manifest::ParameterInfo& parameter = state.model->info().parameters[i];
    const double preset = parameter.preset.value_or(0);
    state.values.v[i] = has_parameter(*own, parameter.name) ? values.v[parameter_index(*own, parameter.name)]
                                                            : Rgb{preset, preset, preset};
  }
  return state;
}

void read_light(const manifest::Document& document, const std::string& name, SceneLayout& layout) {
  const manifest::Light& entry = document.lights.at(name);
  const std::string place = manifest::place(document, "/lights/" + name);
  LightSource source;
  LightState state;
  if (entry.model == "directional") {
    source.directional = true;
    source.direction = normalized(entry.parameters.at("towards").vector());
    state.intensity = entry.parameters.at("watt_per_m2").rgb();
  } else if (entry.model == "point" || entry.model == "sphere") {
    source.position_m = entry.parameters.at("position_m").vector();
    state.intensity = entry.parameters.at("watt_per_sr").rgb();
    if (entry.parameters.contains("radius_m")) state.radius_m = entry.parameters.at("radius_m").scalar();
  } else {
    throw Error(Exit::data, place,
                "has the model \"" + entry.model + "\", which explain does not simulate on images yet",
                "use directional, point or sphere; a uniform surrounding is the mechanism light.ambient");
  }
  layout.lights.push_back(source);
  layout.start.lights.push_back(state);
}

double given(const manifest::MechanismUse& use, const std::string& parameter, std::size_t i, double neutral) {
  const auto found = use.parameters.find(parameter);
  if (found == use.parameters.end() || !found->second.given()) return neutral;
  return found->second.value.size() > i ? found->second.value[i] : found->second.value[0];
}

// Calls set(target, place in `on`) for all targets that a use of a mechanism names.
template <class Set>
void for_targets(const std::vector<std::string>& on, const std::vector<std::string>& all, const Set& set) {
  for (std::size_t t = 0; t < all.size(); ++t) {
    const auto found = std::find(on.begin(), on.end(), all[t]);
    if (on.empty() || found != on.end()) set(t, on.empty() ? 0 : static_cast<std::size_t>(found - on.begin()));
  }
}

void set_if_present(SurfaceState& surface, const std::string& parameter, double value) {
  if (has_parameter(*surface.model, parameter))
    surface.values.v[parameter_index(*surface.model, parameter)] = {value, value, value};
}

// The mechanisms that the manifest already switches on belong to the base model.
void read_mechanisms(const manifest::Document& document, const Recordings& recordings, SceneLayout& layout) {
  SceneState& start = layout.start;
  for (const auto& [id, use] : document.mechanisms) {
    if (id == "surface.diffuse-roughness" || id == "surface.interface") {
      for_targets(use.on, layout.surfaces, [&](std::size_t s, std::size_t i) {
        for (const auto& [parameter, value] : use.parameters)
          set_if_present(start.surfaces[s], parameter, given(use, parameter, i, 0));
      });
    } else if (id == "light.finite-size") {
      for_targets(use.on, recordings.lights,
                  [&](std::size_t l, std::size_t i) { start.lights[l].radius_m = given(use, "radius_m", i, 0); });
    } else if (id == "light.direction") {
      for_targets(use.on, recordings.lights, [&](std::size_t l, std::size_t i) {
        start.lights[l].tilt_x_rad = given(use, "tilt_x_rad", i, 0);
        start.lights[l].tilt_y_rad = given(use, "tilt_y_rad", i, 0);
      });
    } else if (id == "light.ambient") {
      start.ambient = {given(use, "radiance_r", 0, 0), given(use, "radiance_g", 0, 0), given(use, "radiance_b", 0, 0)};
    } else if (id == "optics.vignetting") {
      start.falloff = given(use, "falloff", 0, 0);
    } else if (id == "transport.indirect") {
      start.indirect = given(use, "strength", 0, 1);
    }
  }
}

}  // namespace

bool SurfaceState::lambertian() const {
  static const surface::Model* const coated = surface::find("coated-diffuse");
  static const std::size_t sigma = parameter_index(*coated, "sigma_rad"), f0 = parameter_index(*coated, "f0");
  return model == coated && values.scalar(sigma) == 0 && values.scalar(f0) == 0;
}

bool has_parameter(const surface::Model& model, const std::string& name) {
  for (const manifest::ParameterInfo& p : model.info().parameters)
    if (p.name == name) return true;
  return false;
}

std::size_t parameter_index(const surface::Model& model, const std::string& name) {
  for (std::size_t i = 0; i < model.info().parameters.size(); ++i)
    if (model.info().parameters[i].name == name) return i;
  throw Error(Exit::internal, "surface " + model.info().id, "has no parameter \"" + name + "\"");
}

SceneLayout read_scene(const manifest::Document& document, const Recordings& recordings,
                       const std::vector<std::string>& surfaces, Vec3 centre_m) {
  SceneLayout layout;
  layout.surfaces = surfaces;
  layout.centre_m = centre_m;
  for (const std::string& name : surfaces) layout.start.surfaces.push_back(surface_state(document, name));
  for (const std::string& name : recordings.lights) read_light(document, name, layout);
  for (const Recording& image : recordings.images) layout.start.gain.push_back(image.gain.rgb());
  read_mechanisms(document, recordings, layout);
  return layout;
}

}  // namespace gonio::explain::images
