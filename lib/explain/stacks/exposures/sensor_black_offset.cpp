// sensor.black-offset in a stack of exposures.
#include "render/mechanisms/sensor_black_offset.h"

#include <cmath>

#include "explain/stacks/exposure_binding.h"

namespace gonio::explain::stacks::exposures {
namespace {

void enter_offset(StackEntry& entry, const ExposureFacts&) {
  const double scale = entry.stack.full_scale, quantum = entry.stack.quantum;
  Parameter& offset = entry.add("offset", 0.1 * scale);
  offset.lower = -scale, offset.upper = scale, offset.start = 0.005 * scale;
  entry.propose_all();
  // Whether codes were rounded or cut off is not known: up to half a code of offset is nobody's physics.
  if (!(quantum > 0)) return;
  Parameter rounding;
  rounding.name = "rounding";
  rounding.unit = "1";
  rounding.size = quantum;
  rounding.lower = -0.5 * quantum, rounding.upper = 0.5 * quantum;
  rounding.prior_sigma = rounding.size / std::sqrt(12.0);
  entry.add_base(rounding);
}

void set_offset(std::span<const double> p, const Stack&, ReadingChain& chain) {
  chain.offset = p.size() > 1 ? p[0] + p[1] : p[0];
}

}  // namespace

const ExposureBinding& sensor_black_offset() {
  static const ExposureBinding binding{.mechanism = mechanism::sensor_black_offset,
                                       .order = 20,
                                       .written = Written::with_response,
                                       .enter = enter_offset,
                                       .set = set_offset};
  return binding;
}

}  // namespace gonio::explain::stacks::exposures
