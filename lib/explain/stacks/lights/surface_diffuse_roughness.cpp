// surface.diffuse-roughness in a stack of lights.
#include "explain/stacks/light_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_diffuse_roughness();
}

namespace gonio::explain::stacks::lights {
namespace {

void enter_roughness(StackEntry& entry) {
  entry.add("sigma_rad", 0.1);
  entry.propose_all();
}

}  // namespace

const LightBinding& surface_diffuse_roughness() {
  static const LightBinding binding{
      .mechanism = mechanism::surface_diffuse_roughness,
      .order = 20,
      .enter = enter_roughness,
      .set = [](std::span<const double> p, const Stack&, PatchModel& model) { model.sigma_rad = p[0]; }};
  return binding;
}

}  // namespace gonio::explain::stacks::lights
