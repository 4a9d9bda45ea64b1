// surface.sheen in a stack of lights.
#include "explain/stacks/light_binding.h"

namespace gonio::mechanism {
const Mechanism& surface_sheen();
}

namespace gonio::explain::stacks::lights {
namespace {

void enter_sheen(StackEntry& entry) {
  entry.add("sheen", 0.05);
  entry.add("sheen_width", 0.1);
  entry.add("sheen_forward", 0.05);
  entry.propose({0, 1});
  entry.propose({2});
}

void set_sheen(std::span<const double> p, const Stack&, PatchModel& model) {
  model.sheen = p[0];
  model.sheen_width = p[1];
  model.sheen_forward = p[2];
}

}  // namespace

const LightBinding& surface_sheen() {
  static const LightBinding binding{
      .mechanism = mechanism::surface_sheen, .order = 24, .enter = enter_sheen, .set = set_sheen};
  return binding;
}

}  // namespace gonio::explain::stacks::lights
