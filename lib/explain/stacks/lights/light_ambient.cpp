// light.ambient in a stack of lights: of the colour of the lamps, so that one number stands for three.
#include "light/mechanisms/light_ambient.h"

#include "explain/stacks/light_binding.h"
#include "manifest/sections/mechanism_use.h"

namespace gonio::explain::stacks::lights {
namespace {

void enter_ambient(StackEntry& entry) {
  entry.add("radiance_g", 0.01);
  entry.propose_all();
}

void same_in_all_channels(manifest::MechanismUse& use) {
  const auto found = use.parameters.begin()->second;
  const auto sigma = use.sigma.begin()->second;
  for (const char* name : {"radiance_r", "radiance_g", "radiance_b"}) {
    use.parameters[name] = found;
    use.sigma[name] = sigma;
  }
}

}  // namespace

const LightBinding& light_ambient() {
  static const LightBinding binding{
      .mechanism = mechanism::light_ambient,
      .order = 50,
      .enter = enter_ambient,
      .set = [](std::span<const double> p, const Stack&, PatchModel& model) { model.ambient = p[0]; },
      .complete = same_in_all_channels};
  return binding;
}

}  // namespace gonio::explain::stacks::lights
