#include "scene/model_choice.h"

#include <algorithm>
#include <span>

namespace gonio::scene {

using mechanism::Mechanism;

const manifest::ParameterInfo* find_parameter(const manifest::ModelInfo& info, const std::string& name) {
  for (const manifest::ParameterInfo& p : info.parameters)
    if (p.name == name) return &p;
  return nullptr;
}

bool can_express(const manifest::ModelInfo& info, const Mechanism& mechanism) {
  return std::all_of(mechanism.parameters.begin(), mechanism.parameters.end(), [&](const mechanism::Parameter& p) {
    const manifest::ParameterInfo* found = find_parameter(info, p.name);
    return found && found->components == 1 && found->preset;
  });
}

namespace {

bool includes(const manifest::ModelInfo& large, const manifest::ModelInfo& small) {
  return std::all_of(small.parameters.begin(), small.parameters.end(), [&](const manifest::ParameterInfo& p) {
    const manifest::ParameterInfo* found = find_parameter(large, p.name);
    return found && found->components == p.components && (found->preset || !p.preset);
  });
}

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

}  // namespace

const surface::Model* model_for(const Surface& s, const Mechanism& m) {
  return model_for(s.model, surface::all_models(), m);
}
const light::Model* model_for(const Light& l, const Mechanism& m) {
  return model_for(l.model, light::all_models(), m);
}

const light::Model* model_with(const Light& l, std::span<const std::string> names) {
  const auto has_all = [&](const manifest::ModelInfo& info) {
    return std::all_of(names.begin(), names.end(), [&](const std::string& name) {
      const manifest::ParameterInfo* found = find_parameter(info, name);
      return found && found->components == 1;
    });
  };
  const manifest::ModelInfo& present = l.model->info();
  if (has_all(present)) return l.model;
  const light::Model* best = nullptr;
  for (const light::Model* candidate : light::all_models()) {
    const manifest::ModelInfo& info = candidate->info();
    if (info.attachment != present.attachment || !has_all(info) || !includes(info, present)) continue;
    if (!best || info.parameters.size() < best->info().parameters.size()) best = candidate;
  }
  return best;
}

std::vector<double> components(Vec3 v) {
  return {v.x, v.y, v.z};
}

}  // namespace gonio::scene
