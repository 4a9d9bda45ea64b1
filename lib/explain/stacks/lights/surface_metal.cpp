// surface.metal in a stack of lights.
#include "explain/stacks/light_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_metal();
}

namespace gonio::explain::stacks::lights {
namespace {

void enter_metal(StackEntry& entry) {
  entry.add("metal", 0.1);
  entry.add("metal_alpha", 0.1);
  entry.propose_all();
}

void set_metal(std::span<const double> p, const Stack&, PatchModel& model) {
  model.metal = p[0];
  model.metal_alpha = p[1];
}

}  // namespace

const LightBinding& surface_metal() {
  static const LightBinding binding{
      .mechanism = mechanism::surface_metal, .order = 22, .enter = enter_metal, .set = set_metal};
  return binding;
}

}  // namespace gonio::explain::stacks::lights
