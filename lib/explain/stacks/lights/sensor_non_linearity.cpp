// sensor.non-linearity in a stack of lights: a power law, alone, with a toe or with a shoulder, or a quadratic. A tone
// curve needs exposures.
#include "render/mechanisms/sensor_non_linearity.h"

#include "explain/stacks/light_binding.h"

namespace gonio::explain::stacks::lights {
namespace {

void enter_response(StackEntry& entry) {
  entry.add("gamma", 0.2);
  entry.add("quadratic", 0.1);
  entry.add("toe", 0.05);
  entry.add("shoulder", 0.5);
  entry.propose({0});
  entry.propose({1});
  entry.propose({0, 2});
  entry.propose({0, 3});
}

void set_response(std::span<const double> p, const Stack& stack, PatchModel& model) {
  model.response = {.quadratic = p[1], .gamma = p[0], .reference = stack.full_scale, .toe = p[2], .shoulder = p[3]};
}

}  // namespace

const LightBinding& sensor_non_linearity() {
  static const LightBinding binding{.mechanism = mechanism::sensor_non_linearity,
                                    .order = 60,
                                    .written = Written::as_response,
                                    .enter = enter_response,
                                    .set = set_response};
  return binding;
}

}  // namespace gonio::explain::stacks::lights
