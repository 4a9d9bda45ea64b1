// surface.retro-reflection in a stack of lights.
#include "explain/stacks/light_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_retro_reflection();
}

namespace gonio::explain::stacks::lights {
namespace {

void enter_retro_reflection(StackEntry& entry) {
  entry.add("retro", 0.05);
  entry.add("retro_alpha", 0.1);
  entry.add("retro_falloff", 0.5);
  entry.propose_all();
}

void set_retro_reflection(std::span<const double> p, const Stack&, PatchModel& model) {
  model.retro = p[0];
  model.retro_alpha = p[1];
  model.retro_falloff = p[2];
}

}  // namespace

const LightBinding& surface_retro_reflection() {
  static const LightBinding binding{.mechanism = mechanism::surface_retro_reflection,
                                    .order = 26,
                                    .enter = enter_retro_reflection,
                                    .set = set_retro_reflection};
  return binding;
}

}  // namespace gonio::explain::stacks::lights
