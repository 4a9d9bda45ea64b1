// Mechanisms of surfaces as parameters of registered surface models, the rule of scene/mechanisms.h: where the model in
// use lacks a mechanism's parameters, the smallest registered one takes its place that has them and all of the present
// one's that differ from their presets. Models without an albedo, that need a file, a surface beneath, tables prepared
// for their values, or that send light elsewhere than where it arrived are not asked.
#pragma once
#include "relighting/term.h"

namespace gonio::relighting {

const Term& surface_rule();
std::vector<Use> surface_candidates(const Setting& setting, const mechanism::Mechanism& mechanism);

// The model that can express `mechanism` on this surface, or null.
const surface::Model* widened(const SurfaceState& surface, const mechanism::Mechanism& mechanism);
// The same surface in that model; what the present one lacks stands at its preset.
void widen(SurfaceState& surface, const surface::Model& model);

}  // namespace gonio::relighting
