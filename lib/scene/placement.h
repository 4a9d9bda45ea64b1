// Mechanisms of objects as edits of a scene's instances: geometry.pose, geometry.scale, geometry.offset,
// geometry.contact. At the neutral values an instance stays as it is, to the last bit.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "mechanism/mechanism.h"
#include "scene/scene.h"

namespace gonio::scene {

// Does this room know how to apply it to objects?
bool applies_to_objects(const mechanism::Mechanism& mechanism);

// `amounts`: one per parameter of the mechanism, in its order.
Instance moved(const Instance& instance, const mechanism::Mechanism& mechanism, std::span<const double> amounts);

// What the manifest says; `use.on` empty: all objects but planes, or those that the mechanism fits. Error(data) at
// `place` for unknown names and counts.
void apply_mechanism(std::vector<Instance>& instances, const mechanism::Mechanism& mechanism,
                     const manifest::MechanismUse& use, const std::string& place);

}  // namespace gonio::scene
