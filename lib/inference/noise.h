// Noise first: the factor on the stated sigma and the blocks that are no measurements of this scene at all.
#pragma once
#include "inference/fit.h"

namespace gonio::inference {

struct NoiseFindings {
  double factor = 1;
  std::size_t outlier_blocks = 0;
};
// Fits the most flexible model (every mechanism at once), asks the domain for its local noise, and sets blocks beyond
// five noise widths aside. Domains with a known noise are left as they are. Changes `system`.
NoiseFindings settle_noise(System& system, const std::vector<double>& start);

}  // namespace gonio::inference
