// sensor.exposure in a stack of exposures: one shutter time that is not what was written down. Asked of the one or two
// pictures that stand out most: a number for every picture would be a response of the exposure, whatever its law.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "explain/stacks/exposure_binding.h"

namespace gonio::mechanism {
const Mechanism& sensor_exposure();
}

namespace gonio::explain::stacks::exposures {
namespace {

constexpr std::size_t least_pictures = 4;  // of which one can stand out

void enter_pictures(StackEntry& entry, const ExposureFacts& facts) {
  const std::span<const double> out = facts.standing_out;
  for (std::size_t g = 0; g < out.size(); ++g) {
    Parameter& p = entry.add_for(entry.stack.images[g].id, "relative", 0.05);
    const double start = std::clamp(std::expm1(out[g]), 0.5 * p.lower, 0.5 * p.upper);
    p.start = std::abs(start) > 1e-3 ? start : p.start;
    p.groups = {g};
  }
  if (out.size() < least_pictures || entry.is_stated()) return;
  std::vector<std::size_t> order(out.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::ranges::stable_sort(order, std::ranges::greater{}, [&](std::size_t g) { return std::abs(out[g]); });
  for (const std::size_t count : {std::size_t{1}, std::size_t{2}}) {
    if (out.size() < least_pictures + count - 1) continue;
    std::vector<std::size_t> odd(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(count));
    std::ranges::sort(odd);
    std::vector<std::string> names;
    for (const std::size_t g : odd) names.push_back(entry.stack.images[g].id);
    entry.propose(odd, std::move(names), count > 1);
  }
}

}  // namespace

const ExposureBinding& sensor_exposure() {
  static const ExposureBinding binding{.mechanism = mechanism::sensor_exposure,
                                       .order = 45,
                                       .enter = enter_pictures,
                                       .set = [](std::span<const double> p, const Stack&, ReadingChain& chain) {
                                         chain.odd.assign(p.begin(), p.end());
                                       }};
  return binding;
}

}  // namespace gonio::explain::stacks::exposures
