// sensor.hot-pixel in a stack of exposures: found before anything is fitted (hot_pixels.h).
#include "explain/stacks/exposure_binding.h"

namespace gonio::mechanism {
const Mechanism& sensor_hot_pixel();
}

namespace gonio::explain::stacks::exposures {
namespace {

void enter_pixels(StackEntry& entry, const ExposureFacts& facts) {
  if (facts.hot.pixels.empty()) return;
  entry.add("share", 1e-4), entry.add("rate_per_s", entry.stack.linear_scale() / facts.shortest_s);
  entry.propose_all();
}

}  // namespace

const ExposureBinding& sensor_hot_pixel() {
  static const ExposureBinding binding{.mechanism = mechanism::sensor_hot_pixel,
                                       .order = 90,
                                       .enter = enter_pixels,
                                       .set = [](std::span<const double>, const Stack&, ReadingChain&) {}};
  return binding;
}

}  // namespace gonio::explain::stacks::exposures
