// light.drift in a stack of exposures whose times are known.
#include "light/mechanisms/light_drift.h"

#include "explain/stacks/exposure_binding.h"

namespace gonio::explain::stacks::exposures {
namespace {

void enter_drift(StackEntry& entry, const ExposureFacts& facts) {
  entry.add("amplitude", 0.1);
  entry.add("time_constant_s", 100);
  if (facts.timed) entry.propose_all();
}

void set_drift(std::span<const double> p, const Stack&, ReadingChain& chain) {
  chain.drift = p[0];
  chain.drift_s = p[1];
}

}  // namespace

const ExposureBinding& light_drift() {
  static const ExposureBinding binding{
      .mechanism = mechanism::light_drift, .order = 60, .enter = enter_drift, .set = set_drift};
  return binding;
}

}  // namespace gonio::explain::stacks::exposures
