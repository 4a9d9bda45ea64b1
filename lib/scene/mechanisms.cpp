// Mechanisms as edits of a scene's parameters (scene/mechanisms.h).
#include "scene/mechanisms.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>

#include "base/error.h"
#include "base/text.h"
#include "camera/intrinsics.h"
#include "light/turn.h"
#include "manifest/sections/mechanism_use.h"
#include "scene/amounts.h"
#include "scene/light_covers.h"
#include "scene/placement.h"
#include "scene/variation.h"
#include "surface/dipole_model.h"
#include "surface/stain.h"

namespace gonio::scene {
namespace {

using mechanism::Mechanism;
using mechanism::Target;
// What has no parameter of a model to set.
using SceneEdit = void (*)(Appearance&, const Amounts&, const std::string& place);
struct LightEdit {
  bool (*applies)(const Light&, const Mechanism&);
  void (*edit)(Light&, const Mechanism&, const Amounts&, Vec3 centre_m, const std::string& place);
};

void set_ambient(Appearance& appearance, const Amounts& amounts, const std::string& place) {
  if (amounts == Amounts{0, 0, 0}) {
    appearance.ambient = nullptr;
    return;
  }
  appearance.ambient = light::find("uniform")->prepare({{"radiance", manifest::Parameter(amounts)}}, {}, place);
}
void set_indirect(Appearance& appearance, const Amounts& amounts, const std::string&) {
  appearance.indirect_strength = amounts[0];
}
void set_vignetting(Appearance& appearance, const Amounts& amounts, const std::string&) {
  appearance.vignetting_falloff = amounts[0];
}
void add_second_source(Appearance& appearance, const Amounts& a, const std::string& place) {
  if (a[0] == 0) return;
  Light light;
  light.id = second_source;
  light.model = light::find("directional");
  light.parameters["towards"] = manifest::Parameter(
      std::vector<double>{std::cos(a[2]) * std::cos(a[1]), std::cos(a[2]) * std::sin(a[1]), std::sin(a[2])});
  light.parameters["watt_per_m2"] = manifest::Parameter(std::vector<double>{a[0], a[0], a[0]});
  if (!appearance.lights.empty()) light.bands = appearance.lights[0].bands;
  refresh(light, place);
  appearance.lights.push_back(std::move(light));
}
const std::map<std::string, SceneEdit>& scene_edits() {
  static const std::map<std::string, SceneEdit> edits = {{"light.ambient", set_ambient},
                                                         {"light.second-source", add_second_source},
                                                         {"optics.vignetting", set_vignetting},
                                                         {"transport.indirect", set_indirect}};
  return edits;
}
const manifest::ParameterInfo* find_parameter(const manifest::ModelInfo& info, const std::string& name) {
  for (const manifest::ParameterInfo& p : info.parameters)
    if (p.name == name) return &p;
  return nullptr;
}

// All parameters of the mechanism are there, single numbers that may be left out.
bool can_express(const manifest::ModelInfo& info, const Mechanism& mechanism) {
  return std::all_of(mechanism.parameters.begin(), mechanism.parameters.end(), [&](const mechanism::Parameter& p) {
    const manifest::ParameterInfo* found = find_parameter(info, p.name);
    return found && found->components == 1 && found->preset;
  });
}

bool includes(const manifest::ModelInfo& large, const manifest::ModelInfo& small) {
  return std::all_of(small.parameters.begin(), small.parameters.end(), [&](const manifest::ParameterInfo& p) {
    const manifest::ParameterInfo* found = find_parameter(large, p.name);
    return found && found->components == p.components && (found->preset || !p.preset);
  });
}

// The present model where it can express the mechanism, else the smallest registered one that has all the present one
// has and can; null where none does.
template <class Model>
const Model* model_for(const Model* present, std::span<const Model* const> all, const Mechanism& mechanism) {
  if (can_express(present->info(), mechanism)) return present;
  const bool clash = std::any_of(mechanism.parameters.begin(), mechanism.parameters.end(),
                                 [&](const auto& p) { return find_parameter(present->info(), p.name) != nullptr; });
  if (clash) return nullptr;
  const Model* best = nullptr;
  for (const Model* candidate : all) {
    const manifest::ModelInfo& info = candidate->info();
    if (info.attachment != present->info().attachment) continue;
    if (!can_express(info, mechanism) || !includes(info, present->info())) continue;
    if (!best || info.parameters.size() < best->info().parameters.size()) best = candidate;
  }
  return best;
}

const surface::Model* model_for(const Surface& s, const Mechanism& m) {
  return model_for(s.model, surface::all_models(), m);
}
const light::Model* model_for(const Light& l, const Mechanism& m) {
  return model_for(l.model, light::all_models(), m);
}

std::vector<double> components(Vec3 v) {
  return {v.x, v.y, v.z};
}

bool can_turn(const Light& light, const Mechanism&) {
  return find_parameter(light.model->info(), "towards") || find_parameter(light.model->info(), "position_m");
}
// Lamps that face somewhere are turned with their place, as if they hung from the scene's centre.
void turn(Light& light, const Mechanism&, const Amounts& amounts, Vec3 centre_m, const std::string&) {
  if (const auto towards = light.parameters.find("towards"); towards != light.parameters.end()) {
    const Vec3 given = towards->second.vector();
    towards->second.value = components(light::turned(normalized(given), amounts[0], amounts[1]) * norm(given));
  } else if (const auto position = light.parameters.find("position_m"); position != light.parameters.end()) {
    const Vec3 from = position->second.vector();
    position->second.value = components(light::turned_about(from, amounts[0], amounts[1], centre_m));
    for (const char* name : {"direction", "up"})
      if (const auto axis = light.parameters.find(name); axis != light.parameters.end() && axis->second.given())
        axis->second.value =
            components(light::turned_with(axis->second.vector(), from, amounts[0], amounts[1], centre_m));
  }
}

bool can_narrow(const Light& light, const Mechanism& mechanism) {
  return find_parameter(light.model->info(), "position_m") && model_for(light, mechanism);
}
// light.lobe: adds to the exponent of the lamp; one that has none shone equally all round, and now faces the centre.
void narrow(Light& light, const Mechanism& mechanism, const Amounts& amounts, Vec3 centre_m, const std::string& place) {
  const manifest::ParameterInfo* own = find_parameter(light.model->info(), "exponent");
  light.model = model_for(light, mechanism);
  manifest::Parameter& exponent = light.parameters["exponent"];
  exponent = manifest::Parameter((exponent.given() ? exponent.scalar() : own ? *own->preset : 0) + amounts[0]);
  manifest::Parameter& direction = light.parameters["direction"];
  if (direction.given()) return;
  const Vec3 axis = centre_m - light.parameters.at("position_m").vector();
  if (!(norm(axis) > 0))
    throw Error(Exit::data, place_of(place, "on"),
                "\"" + light.id + "\" stands in the scene's centre and faces nowhere",
                "give it a model with a direction");
  direction = manifest::Parameter(components(axis));
}

bool can_shift(const Light& light, const Mechanism&) {
  return find_parameter(light.model->info(), "position_m") != nullptr;
}
void shift(Light& light, const Mechanism&, const Amounts& amounts, Vec3, const std::string&) {
  manifest::Parameter& position = light.parameters.at("position_m");
  position.value = components(position.vector() + Vec3{amounts[0], amounts[1], amounts[2]});
}

// light.inverse-square: a lamp at 1 / nearness from the centre that gives a plane there what the distant one gave.
bool can_come_near(const Light& light, const Mechanism&) {
  return light.model->info().id == "directional";
}
void come_near(Light& light, const Mechanism&, const Amounts& amounts, Vec3 centre_m, const std::string&) {
  const double distance_m = 1 / amounts[0];
  const Vec3 towards = normalized(light.parameters.at("towards").vector());
  const Rgb intensity = light.parameters.at("watt_per_m2").rgb() * (distance_m * distance_m);
  light.model = light::find("point");
  light.parameters = {{"position_m", manifest::Parameter(components(centre_m + towards * distance_m))},
                      {"watt_per_sr", manifest::Parameter(components(intensity))}};
}

const std::map<std::string, LightEdit>& light_edits() {
  static const std::map<std::string, LightEdit> edits = {{"light.direction", {can_turn, turn}},
                                                         {"light.inverse-square", {can_come_near, come_near}},
                                                         {"light.lobe", {can_narrow, narrow}},
                                                         {"light.position", {can_shift, shift}}};
  return edits;
}

// surface.subsurface: a matte surface becomes a half space of the same albedo with the given diffuse mean free paths
// and no interface; the standard dipole spreads the light.
bool can_scatter(const Surface& surface) {
  return surface.model->info().id == "diffuse" && !surface.varies() && !surface.base;
}
double single_albedo(double albedo) {  // the alpha' at which diffusion theory sends back `albedo`
  const surface::InteriorFresnel interior(1);
  double low = 0, high = 1;
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    (surface::standard_reflectance({1 - middle, middle, 0}, interior) < albedo ? low : high) = middle;
  }
  return 0.5 * (low + high);
}
void scatter(Surface& surface, const Amounts& amounts) {
  constexpr double shortest_m = 1e-6;  // of a band without: far below any pixel
  const Rgb albedo = surface.values.rgb(0);
  std::vector<double> absorbs, scatters;
  for (int c = 0; c < 3; ++c) {
    const double a = std::min(single_albedo(albedo[c]), 1 - 1e-6);
    const double per_m = 1 / (std::max(shortest_m, amounts[static_cast<std::size_t>(c)]) * std::sqrt(3 * (1 - a)));
    absorbs.push_back((1 - a) * per_m);
    scatters.push_back(a * per_m);
  }
  surface.model = surface::find("dipole");
  surface.parameters = {{"eta", manifest::Parameter(1.0)},
                        {"sigma_a_per_m", manifest::Parameter(absorbs)},
                        {"sigma_s_per_m", manifest::Parameter(scatters)}};
}

// surface.spatial-variation: the albedo of a uniform surface with a stain.
class StainedAlbedo final : public Rule {
 public:
  StainedAlbedo(Rgb albedo, const Amounts& amounts) : albedo_(albedo), a_(amounts) {}
  Rgb at(const Place& place) const override {
    return albedo_ * surface::stain(place.position_m, {a_[0], a_[1], a_[2]}, a_[3], a_[4]);
  }
  void fits(const mesh::Mesh*, const manifest::ParameterInfo&, const std::string&) const override {}

 private:
  Rgb albedo_;
  Amounts a_;
};
bool can_stain(const Surface& surface) {
  return find_parameter(surface.model->info(), "albedo") && !surface.varies();
}
void stain(Surface& surface, const Amounts& amounts) {
  const auto& own = surface.model->info().parameters;
  const auto albedo = std::find_if(own.begin(), own.end(), [](const auto& p) { return p.name == "albedo"; });
  const Rgb value = surface.values.rgb(static_cast<std::size_t>(albedo - own.begin()));
  surface.varying.push_back({"albedo", std::make_shared<const StainedAlbedo>(value, amounts)});
}

// Edits of surfaces that are not parameters of a model.
struct SurfaceEdit {
  bool (*applies)(const Surface&);
  void (*edit)(Surface&, const Amounts&);
};
const std::map<std::string, SurfaceEdit>& surface_edits() {
  static const std::map<std::string, SurfaceEdit> edits = {{"surface.subsurface", {can_scatter, scatter}},
                                                           {"surface.spatial-variation", {can_stain, stain}}};
  return edits;
}

bool can_apply(const Surface& surface, const Mechanism& mechanism) {
  const auto special = surface_edits().find(mechanism.id);
  if (special != surface_edits().end()) return special->second.applies(surface);
  return model_for(surface, mechanism) != nullptr;
}
bool can_apply(const Light& light, const Mechanism& mechanism) {
  if (covers(mechanism)) return can_cover(light, mechanism);
  const auto special = light_edits().find(mechanism.id);
  return special != light_edits().end() ? special->second.applies(light, mechanism)
                                        : model_for(light, mechanism) != nullptr;
}

template <class Thing>
void set_parameters(Thing& thing, const Mechanism& mechanism, const Amounts& amounts, const std::string& place) {
  thing.model = model_for(thing, mechanism);
  for (std::size_t i = 0; i < amounts.size(); ++i)
    thing.parameters[mechanism.parameters[i].name] = manifest::Parameter(amounts[i]);
  refresh(thing, place);
}

void edit(Surface& surface, const Mechanism& mechanism, const Amounts& amounts, Vec3, const std::string& place) {
  const auto special = surface_edits().find(mechanism.id);
  if (special != surface_edits().end()) {
    special->second.edit(surface, amounts);
    return refresh(surface, place);
  }
  set_parameters(surface, mechanism, amounts, place);
}
void edit(Light& light, const Mechanism& mechanism, const Amounts& amounts, Vec3 centre_m, const std::string& place) {
  if (covers(mechanism)) return cover(light, mechanism, amounts, centre_m);
  const auto special = light_edits().find(mechanism.id);
  if (special == light_edits().end()) return set_parameters(light, mechanism, amounts, place);
  special->second.edit(light, mechanism, amounts, centre_m, place);
  refresh(light, place);
}

template <class Thing>
void edit_each(std::vector<Thing>& things, const Mechanism& mechanism, const manifest::MechanismUse& use,
               const std::vector<std::string>& on, Vec3 centre_m, const std::string& place) {
  for (std::size_t i = 0; i < on.size(); ++i) {
    const auto thing = std::find_if(things.begin(), things.end(), [&](const Thing& t) { return t.id == on[i]; });
    if (thing == things.end())
      throw Error(Exit::data, place_of(place, "on"), "nothing here is called \"" + on[i] + "\"",
                  "name a surface or light");
    if (!can_apply(*thing, mechanism))
      throw Error(Exit::data, place_of(place, "on"),
                  mechanism.id + " does not apply to \"" + on[i] + "\", whose model is " + thing->model->info().id,
                  "leave this name out");
    const Amounts amounts = amounts_of(mechanism, use, i, on.size(), place);
    if (!neutral(mechanism, amounts)) edit(*thing, mechanism, amounts, centre_m, place);
  }
}

template <class Thing>
std::vector<std::string> names_that_take(const std::vector<Thing>& things, const Mechanism& mechanism) {
  std::vector<std::string> names;
  for (const Thing& thing : things)
    if (can_apply(thing, mechanism)) names.push_back(thing.id);
  return names;
}

}  // namespace

std::vector<std::string> mechanism_targets(const Appearance& appearance, const Mechanism& mechanism) {
  if (mechanism.target == Target::surface) return names_that_take(appearance.surfaces, mechanism);
  if (mechanism.target == Target::light) return names_that_take(appearance.lights, mechanism);
  return {};
}

bool applies_to_scenes(const Mechanism& mechanism) {
  const auto expressed = [&](const auto& all) {
    return std::any_of(all.begin(), all.end(), [&](const auto* m) { return can_express(m->info(), mechanism); });
  };
  switch (mechanism.target) {
    case Target::scene: return scene_edits().contains(mechanism.id);
    case Target::surface: return surface_edits().contains(mechanism.id) || expressed(surface::all_models());
    case Target::light:
      return covers(mechanism) || light_edits().contains(mechanism.id) || expressed(light::all_models());
    case Target::object: return applies_to_objects(mechanism);
    default: return false;
  }
}

bool beyond_rendering(const Mechanism& mechanism) {
  return mechanism.id == "surface.fluorescence" || mechanism.id == "transport.caustic";
}

void apply_mechanism(Appearance& appearance, const Mechanism& mechanism, const manifest::MechanismUse& use,
                     Vec3 centre_m, const std::string& place) {
  if (beyond_rendering(mechanism)) return;
  const std::vector<std::string> on = use.on.empty() ? mechanism_targets(appearance, mechanism) : use.on;
  if (mechanism.target == Target::surface) return edit_each(appearance.surfaces, mechanism, use, on, centre_m, place);
  if (mechanism.target == Target::light) return edit_each(appearance.lights, mechanism, use, on, centre_m, place);
  const auto found = scene_edits().find(mechanism.id);
  if (found != scene_edits().end()) found->second(appearance, amounts_of(mechanism, use, 0, 1, place), place);
}

}  // namespace gonio::scene
