// optics.vignetting in a stack of lights.
#include "scene/mechanisms/optics_vignetting.h"

#include "explain/stacks/light_binding.h"

namespace gonio::explain::stacks::lights {
namespace {

void enter_falloff(StackEntry& entry) {
  entry.add("falloff", 0.1);
  entry.propose_all();
}

}  // namespace

const LightBinding& optics_vignetting() {
  static const LightBinding binding{
      .mechanism = mechanism::optics_vignetting,
      .order = 80,
      .enter = enter_falloff,
      .set = [](std::span<const double> p, const Stack&, PatchModel& model) { model.falloff = p[0]; }};
  return binding;
}

}  // namespace gonio::explain::stacks::lights
