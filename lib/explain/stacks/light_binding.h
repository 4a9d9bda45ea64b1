// Mechanisms in a stack of lights: one file each, lights/<id with _>.cpp, which defines
// `const LightBinding& <id with _>()` in namespace gonio::explain::stacks::lights; the build gathers them.
#pragma once
#include <span>
#include <string>

#include "explain/stacks/photometric_model.h"
#include "explain/stacks/stack_binding.h"

namespace gonio::explain::stacks {

struct LightBinding {
  const mechanism::Mechanism& (*mechanism)() = nullptr;
  int order = 0;  // of numbers and candidates: ascending
  Written written = Written::as_mechanism;
  void (*enter)(StackEntry& entry) = nullptr;
  // What was entered, with these values, into the model of a patch, or into lamp number `lamp` as a place sees it.
  void (*set)(std::span<const double> numbers, const Stack& stack, PatchModel& model) = nullptr;
  void (*aim)(std::span<const double> numbers, std::size_t lamp, Vec3 at, PatchLight& light) = nullptr;
  // Numbers of the mechanism that a stack cannot tell from those that were entered.
  void (*complete)(manifest::MechanismUse& use) = nullptr;
  std::string (*remark)(std::span<const double> numbers) = nullptr;  // a sentence where it is named
};

std::span<const LightBinding* const> all_light_bindings();  // by name; defined in a generated source

}  // namespace gonio::explain::stacks
