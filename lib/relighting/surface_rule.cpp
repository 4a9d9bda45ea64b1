#include "relighting/surface_rule.h"

#include <algorithm>

#include "relighting/uses.h"

namespace gonio::relighting {
namespace {

using mechanism::Mechanism;

const manifest::ParameterInfo* find_parameter(const surface::Model& model, const std::string& name) {
  for (const manifest::ParameterInfo& p : model.info().parameters)
    if (p.name == name) return &p;
  return nullptr;
}

bool expresses(const surface::Model& model, const Mechanism& mechanism) {
  return std::all_of(mechanism.parameters.begin(), mechanism.parameters.end(), [&](const mechanism::Parameter& p) {
    const manifest::ParameterInfo* found = find_parameter(model, p.name);
    return found && found->components == 1 && found->preset;
  });
}

// Has every parameter of `surface` that says more than its preset.
bool carries(const surface::Model& model, const SurfaceState& surface) {
  const std::vector<manifest::ParameterInfo>& own = surface.model->info().parameters;
  for (std::size_t i = 0; i < own.size(); ++i) {
    const manifest::ParameterInfo* there = find_parameter(model, own[i].name);
    if (there && there->components == own[i].components) continue;
    const double preset = own[i].preset.value_or(0);
    if (!own[i].preset || !(surface.values.v[i] == Rgb{preset, preset, preset})) return false;
  }
  return true;
}

surface::Values presets(const surface::Model& model) {
  surface::Values values;
  for (std::size_t i = 0; i < model.info().parameters.size(); ++i) {
    const double preset = model.info().parameters[i].preset.value_or(0.5);
    values.v[i] = {preset, preset, preset};
  }
  return values;
}

bool simple(const surface::Model& model) {
  const manifest::ModelInfo& info = model.info();
  if (info.attachment != manifest::Attachment::none || info.takes_base || model.transmits() || model.thin())
    return false;
  const surface::Values values = presets(model);
  return !model.prepare(values, {}, info.id) && !model.subsurface(values);
}

const std::vector<const surface::Model*>& simple_models() {
  static const std::vector<const surface::Model*> all = [] {
    std::vector<const surface::Model*> models;
    for (const surface::Model* m : surface::all_models())
      if (has_parameter(*m, "albedo") && simple(*m)) models.push_back(m);
    return models;
  }();
  return all;
}

void edit(const Use& use, std::size_t, const SceneLayout&, const Recordings&, SceneState& state) {
  for (std::size_t t = 0; t < use.targets.size(); ++t) {
    SurfaceState& surface = state.surfaces[use.targets[t]];
    const surface::Model* model = widened(surface, *use.mechanism);
    if (!model) continue;  // no model has this mechanism and another one that is on: nothing to try
    widen(surface, *model);
    const std::span<const double> amounts = use.amounts(state, t);
    for (std::size_t k = 0; k < amounts.size(); ++k)
      surface.values.v[parameter_index(*model, use.mechanism->parameters[k].name)] = {amounts[k], amounts[k],
                                                                                      amounts[k]};
  }
}

}  // namespace

void widen(SurfaceState& surface, const surface::Model& model) {
  if (surface.model == &model) return;
  SurfaceState wide{&model, presets(model)};
  const std::vector<manifest::ParameterInfo>& own = surface.model->info().parameters;
  for (std::size_t i = 0; i < own.size(); ++i)
    if (has_parameter(model, own[i].name)) wide.values.v[parameter_index(model, own[i].name)] = surface.values.v[i];
  surface = wide;
}

const surface::Model* widened(const SurfaceState& surface, const Mechanism& mechanism) {
  if (expresses(*surface.model, mechanism)) return surface.model;
  const surface::Model* best = nullptr;
  for (const surface::Model* m : simple_models()) {
    if (!expresses(*m, mechanism) || !carries(*m, surface)) continue;
    if (!best || m->info().parameters.size() < best->info().parameters.size()) best = m;
  }
  return best;
}

const Term& surface_rule() {
  static const Term term{.reach = Reach::surfaces, .edit = edit};
  return term;
}

std::vector<Use> surface_candidates(const Setting& setting, const Mechanism& mechanism) {
  std::vector<Use> uses;
  // Facets know no direction along the surface: what turns with the sample is a matter of tables.
  const std::vector<std::string>& conditions = mechanism.conditions;
  if (std::find(conditions.begin(), conditions.end(), "surface.azimuth") != conditions.end()) return uses;
  for (std::size_t s = 0; s < setting.layout.surfaces.size(); ++s) {
    const std::string& name = setting.layout.surfaces[s];
    const SurfaceState& surface = setting.layout.start.surfaces[s];
    if (switched_on(setting.document, mechanism.id, name) || !widened(surface, mechanism)) continue;
    // A base model that has the mechanism's parameters and uses them has the mechanism.
    const mechanism::Parameter& first = mechanism.parameters[0];
    if (has_parameter(*surface.model, first.name) &&
        surface.values.scalar(parameter_index(*surface.model, first.name)) != first.neutral)
      continue;
    for (Use& use : in_forms(target_use(mechanism, {name}, {s}, false))) uses.push_back(std::move(use));
  }
  return uses;
}

}  // namespace gonio::relighting
