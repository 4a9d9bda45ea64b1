// Waves along one condition with one period and a phase and size of their own in each group: bands of lamps that
// flicker, begun anew with every picture. Pooled over groups they cancel, so that no curve over the condition shows
// them.
//
// With a = direction over sigma, r the whitened residual less a constant and a slope of its own in each group, and u_b
// the sums over blocks of a r (cos, sin)(2 pi x / P), the statistic of a period is
//   W = sum over groups of u' (sum_b u_b u_b')^-1 u,  u = sum_b u_b
// chi-square with two degrees for each group where there is no wave, whatever the noise of single blocks is. Periods
// are tried from a third of the range down to three values of the condition that differ, two to the resolved frequency
// and finer about the best; the p-value counts them all.
#pragma once
#include <vector>

#include "inference/system.h"

namespace gonio::inference {

struct OwnPhase {
  std::size_t condition = 0;
  double period = 0;  // in the condition's unit
  double p = 1;       // among all periods of all conditions that are asked
};
// For each condition that is to be asked within groups, its best period.
std::vector<OwnPhase> own_phases(const System& system, const std::vector<double>& values);

}  // namespace gonio::inference
