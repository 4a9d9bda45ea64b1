// Covers of lamps that no parameter of a model expresses: what the lamp sends out is changed on its way by a sheet
// (light/polarized_emitter.h) or walls (light/near_environment.h).
#pragma once
#include <memory>

#include "scene/scene.h"

namespace gonio::scene {

// An emitter that was prepared anew, covered as `before` was.
std::shared_ptr<const light::Emitter> covered_as(const std::shared_ptr<const light::Emitter>& before,
                                                 std::shared_ptr<const light::Emitter> fresh);

}  // namespace gonio::scene
