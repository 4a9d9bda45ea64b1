// sensor.shutter in a stack of exposures.
#include "render/mechanisms/sensor_shutter.h"

#include <algorithm>

#include "explain/stacks/exposure_binding.h"

namespace gonio::explain::stacks::exposures {
namespace {

void enter_shutter(StackEntry& entry, const ExposureFacts& facts) {
  Parameter& extra = entry.add("extra_s", facts.shortest_s);
  extra.lower = std::max(extra.lower, -0.5 * facts.shortest_s);
  extra.start = std::min(extra.start, 0.01 * facts.shortest_s);
  entry.propose_all();
}

}  // namespace

const ExposureBinding& sensor_shutter() {
  static const ExposureBinding binding{
      .mechanism = mechanism::sensor_shutter,
      .order = 40,
      .enter = enter_shutter,
      .set = [](std::span<const double> p, const Stack&, ReadingChain& chain) { chain.extra_s = p[0]; }};
  return binding;
}

}  // namespace gonio::explain::stacks::exposures
