// Mechanisms as edits of a scene's parameters (scene/mechanisms.h).
#include "scene/mechanisms.h"

#include <algorithm>

#include "base/error.h"
#include "manifest/sections/mechanism_use.h"
#include "scene/amounts.h"
#include "scene/edit.h"
#include "scene/model_choice.h"
#include "scene/placement.h"

namespace gonio::scene {
namespace {

using mechanism::Mechanism;
using mechanism::Target;

bool can_apply(const Surface& surface, const Mechanism& mechanism) {
  const Edit* own = find_edit(mechanism);
  return own != nullptr && own->surface != nullptr ? own->fits_surface(surface)
                                                   : model_for(surface, mechanism) != nullptr;
}
bool can_apply(const Light& light, const Mechanism& mechanism) {
  const Edit* own = find_edit(mechanism);
  return own != nullptr && own->fits_light != nullptr ? own->fits_light(light) : model_for(light, mechanism) != nullptr;
}

template <class Thing>
void set_parameters(Thing& thing, const Mechanism& mechanism, const Amounts& amounts) {
  thing.model = model_for(thing, mechanism);
  for (std::size_t i = 0; i < amounts.size(); ++i)
    thing.parameters[mechanism.parameters[i].name] = manifest::Parameter(amounts[i]);
}

void edit(Surface& surface, const Mechanism& mechanism, const Amounts& amounts, Vec3, const std::string& place) {
  const Edit* own = find_edit(mechanism);
  if (own != nullptr && own->surface != nullptr)
    own->surface(surface, amounts);
  else
    set_parameters(surface, mechanism, amounts);
  refresh(surface, place);
}
void edit(Light& light, const Mechanism& mechanism, const Amounts& amounts, Vec3 centre_m, const std::string& place) {
  const Edit* own = find_edit(mechanism);
  if (own != nullptr && own->light != nullptr)
    own->light(light, amounts, centre_m, place);
  else
    set_parameters(light, mechanism, amounts);
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

// Beside the lights that are named, in play with amounts of their own, others.
void add_companions(std::vector<Light>& lights, const Edit& own, const Mechanism& mechanism,
                    const manifest::MechanismUse& use, const std::vector<std::string>& on, const std::string& place) {
  for (std::size_t i = 0; i < on.size(); ++i) {
    const auto found = std::find_if(lights.begin(), lights.end(), [&](const Light& l) { return l.id == on[i]; });
    if (found == lights.end() || !own.fits_light(*found))
      throw Error(Exit::data, place_of(place, "on"), mechanism.id + " does not apply to \"" + on[i] + "\"",
                  "name a light with a position");
    const Amounts amounts = amounts_of(mechanism, use, i, on.size(), place);
    if (neutral(mechanism, amounts) || amounts[0] == 0) continue;
    Light companion = own.companion(*found, amounts, place);
    companion.id = mechanism.id + " " + on[i];
    refresh(companion, place);
    lights.push_back(std::move(companion));
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

bool go_together(const Surface& surface, const Mechanism& a, const Mechanism& b) {
  const Mechanism &first = a.id < b.id ? a : b, &second = a.id < b.id ? b : a;
  if (beyond_rendering(first) || beyond_rendering(second)) return true;
  if (!can_apply(surface, first)) return false;
  Amounts amounts;
  for (const mechanism::Parameter& p : first.parameters) amounts.push_back(p.start);
  Surface changed = surface;
  edit(changed, first, amounts, {}, "go_together");
  return can_apply(changed, second);
}

bool applies_to_scenes(const Mechanism& mechanism) {
  const auto expressed = [&](const auto& all) {
    return std::any_of(all.begin(), all.end(), [&](const auto* m) { return can_express(m->info(), mechanism); });
  };
  const Edit* own = find_edit(mechanism);
  switch (mechanism.target) {
    case Target::scene: return own != nullptr && (own->appearance != nullptr || own->picture != nullptr);
    case Target::surface: return (own != nullptr && own->surface != nullptr) || expressed(surface::all_models());
    case Target::light:
      return (own != nullptr && (own->light != nullptr || own->companion != nullptr)) || expressed(light::all_models());
    case Target::object: return applies_to_objects(mechanism);
    default: return false;
  }
}

bool beyond_rendering(const Mechanism& mechanism) {
  const Edit* own = find_edit(mechanism);
  return own != nullptr && own->beyond_rendering;
}

void apply_mechanism(Appearance& appearance, const Mechanism& mechanism, const manifest::MechanismUse& use,
                     Vec3 centre_m, const std::string& place) {
  if (beyond_rendering(mechanism)) return;
  const std::vector<std::string> on = use.on.empty() ? mechanism_targets(appearance, mechanism) : use.on;
  if (mechanism.target == Target::surface) return edit_each(appearance.surfaces, mechanism, use, on, centre_m, place);
  const Edit* own = find_edit(mechanism);
  if (own != nullptr && own->companion != nullptr)
    return add_companions(appearance.lights, *own, mechanism, use, on, place);
  if (mechanism.target == Target::light) return edit_each(appearance.lights, mechanism, use, on, centre_m, place);
  if (own != nullptr && own->appearance != nullptr)
    own->appearance(appearance, amounts_of(mechanism, use, 0, 1, place), centre_m, place);
}

}  // namespace gonio::scene
