// Observations that do not follow: a solver's model is fitted so that these cannot bend it, then every observation is
// held against what the others predict.
//
// Fit (robust_tracks.h): shapes point by point, turns and translations (and scales, where the solver freed them) frame
// by frame, in turns, by reweighted least squares: least distances first, then Tukey's biweight (Huber & Ronchetti
// 2009, sections 4.8, 7.8); the shapes' weights over time are the solver's. At last least squares without what lies
// outside, until that stays the same. Test: D = |r|^2 / (sigma^2 (1 -+ h)), h the observation's leverage, where noise
// is normal D / 2 is F(2, nu) as sigma is known no better than from nu observations, so that
//   (1 + D / nu)^(-nu / 2) < alpha / N
// for any of N observations has a chance of at most alpha (Bonferroni). sigma is the largest of all observations', from
// the median of |r|^2, the frame's own and, from the lower quartile, as a track may slip for good, the point's own:
// what a model leaves out smoothly widens these and singles out nothing. What of it is left nevertheless, a few points
// that bend away for a while, comes and goes: a run of outliers begins and ends, where that is seen, with a step from
// one frame to the next of 0.7 of what it lies off by.
#pragma once
#include <vector>

#include "nrsfm/solve/followed.h"
#include "nrsfm/solve/solved_model.h"

namespace gonio::nrsfm {

Outliers find_outliers(const Solved& solved, double false_alarm);

// The sequence with those observations hidden.
Sequence without(const Sequence& sequence, const std::vector<Run>& runs);

}  // namespace gonio::nrsfm
