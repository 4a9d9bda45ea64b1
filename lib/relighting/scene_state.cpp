#include "relighting/scene_state.h"

#include <algorithm>

#include "base/error.h"
#include "light/light.h"
#include "light/turn.h"
#include "manifest/document.h"
#include "manifest/sections/light.h"
#include "manifest/sections/mechanism_use.h"
#include "manifest/sections/surface.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& transport_indirect();
}

namespace gonio::relighting {
namespace {

SurfaceState surface_state(const manifest::Document& document, const std::string& name) {
  const manifest::Surface& entry = document.surfaces.at(name);
  const std::string place = manifest::place(document, "/surfaces/" + name);
  manifest::Parameters parameters = entry.parameters;
  for (const auto& [parameter, file] : entry.textures) {
    if (parameter != "albedo")
      throw Error(Exit::data, place + "/textures/" + parameter, "is a texture, which explain knows of albedos alone",
                  "give a uniform value");
    parameters[parameter] = manifest::Parameter(0.5);  // until the picture is read (relighting/textures.h)
  }
  const surface::Model* own = surface::find(entry.model);
  if (!own) throw Error(Exit::data, place, "has the unknown model \"" + entry.model + "\"", "see gonio-manifest(5)");
  const surface::Values values = surface::values_of(*own, parameters, place);
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

[[noreturn]] void refuse_light(const manifest::Document& document, const std::string& name) {
  throw Error(Exit::data, manifest::place(document, "/lights/" + name),
              "has the model \"" + document.lights.at(name).model + "\", which explain does not simulate on images yet",
              "use directional, point or sphere; a uniform surrounding is the mechanism light.ambient; render and "
              "compare know all models");
}

bool is_known(const manifest::Light& entry) {
  return entry.model == "directional" || entry.model == "point" || entry.model == "sphere";
}

void read_light(const manifest::Document& document, const std::string& name, SceneLayout& layout) {
  const manifest::Light& entry = document.lights.at(name);
  LightSource source;
  LightState state;
  if (entry.model == "directional") {
    source.directional = true;
    source.direction = normalized(entry.parameters.at("towards").vector());
    state.intensity = entry.parameters.at("watt_per_m2").rgb();
  } else if (is_known(entry)) {
    source.position_m = entry.parameters.at("position_m").vector();
    state.intensity = entry.parameters.at("watt_per_sr").rgb();
    if (entry.parameters.contains("radius_m")) state.radius_m = entry.parameters.at("radius_m").scalar();
  } else {
    refuse_light(document, name);
  }
  layout.lights.push_back(source);
  layout.start.lights.push_back(state);
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

bool knows_lights(const manifest::Document& document) {
  return std::ranges::all_of(lights_of_recordings(document),
                             [&](const std::string& name) { return is_known(document.lights.at(name)); });
}

void check_lights(const manifest::Document& document) {
  for (const std::string& name : lights_of_recordings(document))
    if (!is_known(document.lights.at(name))) refuse_light(document, name);
}

LightSource moved(const LightSource& given, const LightState& state, Vec3 centre_m) {
  LightSource now = given;
  if (given.directional) {
    now.direction = light::turned(given.direction, state.tilt_x_rad, state.tilt_y_rad);
    now.centre_m = centre_m;
    now.nearness_per_m = state.nearness_per_m;
  } else {
    now.position_m =
        light::turned_about(given.position_m, state.tilt_x_rad, state.tilt_y_rad, centre_m) + state.shift_m;
  }
  return now;
}

SceneLayout read_scene(const manifest::Document& document, const Recordings& recordings,
                       const std::vector<std::string>& surfaces, Vec3 centre_m) {
  SceneLayout layout;
  layout.surfaces = surfaces;
  layout.centre_m = centre_m;
  for (const std::string& name : surfaces) layout.start.surfaces.push_back(surface_state(document, name));
  for (const std::string& name : recordings.lights) read_light(document, name, layout);
  for (const Recording& image : recordings.images) layout.start.gain.push_back(image.gain.rgb());
  const auto indirect = document.mechanisms.find(mechanism::transport_indirect().id);
  if (indirect != document.mechanisms.end() && indirect->second.parameters.contains("strength"))
    layout.start.indirect = indirect->second.parameters.at("strength").scalar();
  return layout;
}

}  // namespace gonio::relighting
