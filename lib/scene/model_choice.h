// Which registered model takes a mechanism's parameters (scene/mechanisms.h says the rule).
#pragma once
#include <span>
#include <string>
#include <vector>

#include "mechanism/mechanism.h"
#include "scene/scene.h"

namespace gonio::scene {

// Null where the model has no parameter of that name.
const manifest::ParameterInfo* find_parameter(const manifest::ModelInfo& info, const std::string& name);
// All parameters of the mechanism are there, single numbers that may be left out.
bool can_express(const manifest::ModelInfo& info, const mechanism::Mechanism& mechanism);

// The present model where it can express the mechanism, else the smallest registered one that has all the present one
// has and can; null where none does.
const surface::Model* model_for(const Surface& surface, const mechanism::Mechanism& mechanism);
const light::Model* model_for(const Light& light, const mechanism::Mechanism& mechanism);
// The same for single numbers of these names, given or not.
const light::Model* model_with(const Light& light, std::span<const std::string> names);

std::vector<double> components(Vec3 v);  // as parameters hold them

}  // namespace gonio::scene
