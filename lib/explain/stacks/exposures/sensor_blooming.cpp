// sensor.blooming in a stack of exposures: found in readings that count for nothing else (overflow.h), and by no fit.
#include "render/mechanisms/sensor_blooming.h"

#include "explain/stacks/exposure_binding.h"

namespace gonio::explain::stacks::exposures {
namespace {

void enter_shares(StackEntry& entry, const ExposureFacts& facts) {
  if (!facts.overflow.found()) return;
  for (const char* share : {"along", "across"}) entry.add(share, 0.1);
  entry.add("full_scale", entry.stack.linear_scale());
  entry.propose_all();
}

}  // namespace

const ExposureBinding& sensor_blooming() {
  static const ExposureBinding binding{.mechanism = mechanism::sensor_blooming,
                                       .order = 80,
                                       .enter = enter_shares,
                                       .set = [](std::span<const double>, const Stack&, ReadingChain&) {}};
  return binding;
}

}  // namespace gonio::explain::stacks::exposures
