// surface.interface in a stack of lights.
#include "explain/stacks/light_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_interface();
}

namespace gonio::explain::stacks::lights {
namespace {

constexpr double highest_f0 = 0.2;  // readings need not be on an absolute scale

void enter_interface(StackEntry& entry) {
  entry.add("f0", 0.02).upper = highest_f0;
  entry.add("alpha", 0.1);
  entry.propose_all();
}

void set_interface(std::span<const double> p, const Stack&, PatchModel& model) {
  model.f0 = p[0];
  model.alpha = p[1];
}

}  // namespace

const LightBinding& surface_interface() {
  static const LightBinding binding{
      .mechanism = mechanism::surface_interface, .order = 10, .enter = enter_interface, .set = set_interface};
  return binding;
}

}  // namespace gonio::explain::stacks::lights
