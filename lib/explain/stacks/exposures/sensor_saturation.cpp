// sensor.saturation in a stack of exposures.
#include "render/mechanisms/sensor_saturation.h"

#include <algorithm>

#include "explain/stacks/exposure_binding.h"

namespace gonio::explain::stacks::exposures {
namespace {

void enter_full_scale(StackEntry& entry, const ExposureFacts& facts) {
  const double largest = *std::max_element(facts.readings.begin(), facts.readings.end());
  Parameter& full = entry.add("full_scale", entry.stack.full_scale);
  full.lower = 0.05 * largest, full.upper = 1.5 * largest, full.start = 0.98 * largest;
  // Clipped readings leave no residual, and would promise a number without any uncertainty.
  full.prior_sigma = entry.stack.full_scale;
  entry.propose_all();
}

}  // namespace

const ExposureBinding& sensor_saturation() {
  static const ExposureBinding binding{
      .mechanism = mechanism::sensor_saturation,
      .order = 30,
      .enter = enter_full_scale,
      .set = [](std::span<const double> p, const Stack&, ReadingChain& chain) { chain.full_scale = p[0]; }};
  return binding;
}

}  // namespace gonio::explain::stacks::exposures
