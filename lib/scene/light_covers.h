// Mechanisms of lights that no parameter of a model expresses: what the lamp sends out is changed on its way
// (light/polarized_emitter.h, light/near_environment.h). The model and its parameters stay.
#pragma once
#include "mechanism/mechanism.h"
#include "scene/amounts.h"
#include "scene/scene.h"

namespace gonio::scene {

bool covers(const mechanism::Mechanism& mechanism);
bool can_cover(const Light& light, const mechanism::Mechanism& mechanism);
void cover(Light& light, const mechanism::Mechanism& mechanism, const Amounts& amounts, Vec3 centre_m);

// An emitter that was prepared anew, covered as `before` was.
std::shared_ptr<const light::Emitter> covered_as(const std::shared_ptr<const light::Emitter>& before,
                                                 std::shared_ptr<const light::Emitter> fresh);

}  // namespace gonio::scene
