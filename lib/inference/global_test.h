// The null test's p-value over all looks at the residuals: mechanisms and curves, each a family of scores, calibrated
// by the same sign flips of whole blocks (stats/sign_flip.h says why that needs no noise model).
//
// A family whose parameters are shared stands for fixed numbers: its scores are standardised by their covariance. One
// with a number of its own for every group (a motion for every view) stands for draws of one law about neutral, and is
// tested as a component of variance: the squares of its scores are summed as they are, so that groups that tell much
// count much, and many groups that tell little do not drown them (le Cessie & van Houwelingen, Biometrics 51, 1995;
// Lin, Biometrika 84, 1997). The sum is referred to a chi-square law with its mean and variance (Satterthwaite 1946),
// and the flips calibrate the rest.
#pragma once
#include <cstdint>
#include <vector>

#include "stats/sign_flip.h"

namespace gonio::inference {

struct Look {
  stats::ScoreFamily scores;
  bool of_single_groups = false;  // each direction belongs to one group
};

// The chance of the smallest p among the looks where nothing was left out. `inflation`: rows over degrees of freedom.
double global_p(const std::vector<Look>& looks, std::size_t blocks, double inflation, int draws, std::uint64_t seed);

}  // namespace gonio::inference
