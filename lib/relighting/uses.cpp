#include "relighting/uses.h"

#include <algorithm>

#include "manifest/document.h"
#include "manifest/sections/mechanism_use.h"
#include "mechanism/form.h"
#include "relighting/surface_rule.h"
#include "scene/mechanisms.h"

namespace gonio::relighting {
namespace {

using mechanism::Mechanism;
using mechanism::Target;

bool of_images(const Mechanism& m) {
  return std::find(m.domains.begin(), m.domains.end(), "images") != m.domains.end();
}

// The term of a mechanism, its own file or the rule of surfaces; null where it is no matter of pictures here.
const Term* term_of(const Mechanism& m) {
  if (const Term* own = find_term(m.id)) return own;
  return m.target == Target::surface && of_images(m) ? &surface_rule() : nullptr;
}

std::vector<std::string> names_of(const Setting& s, Target target) {
  std::vector<std::string> names;
  switch (target) {
    case Target::surface: return s.layout.surfaces;
    case Target::light: return s.recordings.lights;
    case Target::object:
      for (const scene::Instance& i : s.scene.instances) names.push_back(i.id);
      return names;
    case Target::camera:
      for (const View& view : s.recordings.views)
        if (std::find(names.begin(), names.end(), view.camera) == names.end()) names.push_back(view.camera);
      return names;
    case Target::scene:
      for (const Recording& image : s.recordings.images) names.push_back(image.id);
      return names;
    default: return {};
  }
}

// A mechanism that the manifest switches on, with its values as starts.
Use given_use(const Setting& s, const Mechanism& m, const manifest::MechanismUse& given) {
  const std::vector<std::string> all = names_of(s, m.target);
  std::vector<std::string> on = given.on;
  std::vector<std::size_t> targets;
  if (on.empty() && m.target != Target::scene) on = all;
  for (const std::string& name : on) {
    const auto found = std::find(all.begin(), all.end(), name);
    targets.push_back(static_cast<std::size_t>(found - all.begin()));
  }
  Use use = target_use(m, on, targets, on.empty());
  for (std::size_t i = 0; i < use.numbers.size(); ++i) {
    const std::size_t set = i / m.parameters.size();
    const mechanism::Parameter& info = m.parameters[i % m.parameters.size()];
    const auto found = given.parameters.find(info.name);
    Number& number = use.numbers[i];
    number.start = info.neutral;
    number.free = false;
    if (found == given.parameters.end() || !found->second.given()) continue;
    number.start = found->second.value[found->second.value.size() > set ? set : 0];
    number.free = found->second.free;
  }
  return use;
}

}  // namespace

bool Use::neutral(const SceneState& state) const {
  if (place >= state.amounts.size()) return true;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    if ((in_play || numbers[i].free) && state.amounts[place][i] != numbers[i].neutral) return false;
  return true;
}

const Term* find_term(const std::string& id) {
  for (const Term* t : all_terms())
    if (t->mechanism().id == id) return t;
  return nullptr;
}

Use scene_use(const Mechanism& mechanism) {
  return target_use(mechanism, {}, {}, true);
}

Use target_use(const Mechanism& mechanism, std::vector<std::string> on, std::vector<std::size_t> targets, bool shared) {
  Use use;
  use.mechanism = &mechanism;
  use.term = term_of(mechanism);
  use.sets = shared ? 1 : on.size();
  use.on = std::move(on);
  use.targets = std::move(targets);
  for (const mechanism::Parameter& p : mechanism.parameters) use.neutral_.push_back(p.neutral);
  for (std::size_t s = 0; s < use.sets; ++s)
    for (const mechanism::Parameter& p : mechanism.parameters)
      use.numbers.push_back({p.neutral, p.start, p.lower, p.upper});
  return use;
}

std::vector<Use> in_forms(const Use& use) {
  const std::span<const mechanism::Form> forms = mechanism::forms_of(*use.mechanism);
  if (forms.empty()) return {use};
  std::vector<Use> all;
  const std::vector<mechanism::Parameter>& infos = use.mechanism->parameters;
  for (const mechanism::Form& form : forms) {
    Use one = use;
    one.finer = form.finer;
    if (one.family.empty()) {
      one.family = use.mechanism->id;
      for (const std::string& name : use.on) one.family += "@" + name;
    }
    for (std::size_t i = 0; i < one.numbers.size(); ++i)
      for (const auto& [name, value] : form.held)
        if (infos[i % infos.size()].name == name) {
          Number& number = one.numbers[i];
          number.neutral = number.start = value;
          number.free = false;
        }
    all.push_back(std::move(one));
  }
  return all;
}

std::optional<Use> lamps_use(const Setting& setting, const Mechanism& mechanism, bool shared,
                             bool (*fits)(const Setting& setting, std::size_t light)) {
  std::vector<std::string> on;
  std::vector<std::size_t> lights;
  for (std::size_t l = 0; l < setting.layout.lights.size(); ++l) {
    const std::string& name = setting.recordings.lights[l];
    if (!fits(setting, l) || switched_on(setting.document, mechanism.id, name)) continue;
    on.push_back(name);
    lights.push_back(l);
  }
  if (on.empty()) return {};
  return target_use(mechanism, on, lights, shared);
}

std::vector<Use> all_or_one_lamp(const Setting& setting, const Mechanism& mechanism, const std::string& family,
                                 bool on_one_frame, bool (*fits)(const Setting& setting, std::size_t light)) {
  std::optional<Use> all = lamps_use(setting, mechanism, false, fits);
  if (!all) return {};
  std::vector<Use> uses{*all};
  if (all->targets.size() > 1) {
    if (on_one_frame) uses.push_back(target_use(mechanism, all->on, all->targets, true));
    for (std::size_t t = 0; t < all->targets.size(); ++t)
      uses.push_back(target_use(mechanism, {all->on[t]}, {all->targets[t]}, false));
  }
  for (Use& use : uses) {
    use.family = family;
    if (use.sets < use.on.size()) continue;
    for (std::size_t i = 0; i < use.numbers.size(); ++i)
      use.numbers[i].groups = lit_by(setting.recordings, use.targets[i / mechanism.parameters.size()]);
  }
  return uses;
}

bool lamps_surround(const Setting& setting) {
  constexpr std::ptrdiff_t least = 3;
  return std::ranges::any_of(setting.recordings.images, [&](const Recording& image) {
    return std::ranges::count_if(image.lights, [&](std::size_t l) { return setting.layout.lights[l].directional; }) >=
           least;
  });
}

std::vector<std::size_t> lit_by(const Recordings& recordings, std::size_t light) {
  std::vector<std::size_t> groups;
  for (std::size_t i = 0; i < recordings.images.size(); ++i) {
    const std::vector<std::size_t>& lights = recordings.images[i].lights;
    if (std::find(lights.begin(), lights.end(), light) != lights.end()) groups.push_back(i);
  }
  return groups.size() == recordings.images.size() ? std::vector<std::size_t>{} : groups;
}

bool switched_on(const manifest::Document& document, const std::string& id, const std::string& target) {
  const auto use = document.mechanisms.find(id);
  if (use == document.mechanisms.end()) return false;
  const std::vector<std::string>& on = use->second.on;
  const auto place = std::find(on.begin(), on.end(), target);
  if (!target.empty() && !on.empty() && place == on.end()) return false;
  // Values that are neutral leave the question open.
  const mechanism::Mechanism* m = mechanism::find_mechanism(id);
  for (const mechanism::Parameter& p : m->parameters) {
    const auto given = use->second.parameters.find(p.name);
    if (given == use->second.parameters.end() || !given->second.given()) continue;
    const std::vector<double>& values = given->second.value;
    const std::size_t i = on.empty() || place == on.end() ? 0 : static_cast<std::size_t>(place - on.begin());
    if (values[std::min(i, values.size() - 1)] != p.neutral) return true;
  }
  return false;
}

std::vector<Use> given_uses(const Setting& setting) {
  std::vector<Use> uses;
  for (const auto& [id, given] : setting.document.mechanisms) {
    const Mechanism* m = mechanism::find_mechanism(id);
    // Rays leave the cameras, and meet the objects, where the mechanisms have put them.
    if (m && (m->target == Target::object || scene::moves_pixels(*m))) continue;
    if (m && term_of(*m)) uses.push_back(given_use(setting, *m, given));
  }
  return uses;
}

std::vector<Use> candidate_uses(const Setting& setting) {
  std::vector<Use> uses;
  for (const Mechanism* m : mechanism::all_mechanisms()) {
    if (!of_images(*m) || !term_of(*m)) continue;
    const Term* own = find_term(m->id);
    for (Use& use : own ? own->candidates(setting) : surface_candidates(setting, *m)) uses.push_back(std::move(use));
  }
  return uses;
}

}  // namespace gonio::relighting
