// Which poses fit together: a solution that a minority of wrong poses cannot bend, and the list of those poses.
//
// A start that wrong poses do not touch: over subsets of three poses (all of them, or 400 drawn in an order that
// depends on the samples alone) the closed form with the least median mismatch (RANSAC without a threshold: Rousseeuw's
// least median of squares, JASA 79, 1984). From its best half the joint refinement grows: a pose counts if its
// Mahalanobis distance, by the noises estimated from the poses that count, stays below the quantile that one right pose
// in a hundred sets exceeds; repeated until nothing changes.
#pragma once
#include "robot/handeye/refinement.h"

namespace gonio::robot::handeye {

struct Consensus {
  Refined refined;
  std::vector<bool> counts;  // false: an outlier
  double limit2 = 0;         // of the squared Mahalanobis distance
};
Consensus find_consensus(const Setup& setup, const std::vector<View>& views);

// Mismatch of every sample with a solution, in units of the reference scatter: medians decide.
Solution least_median_start(const std::vector<PoseSample>& samples, Vec3 middle_m);

}  // namespace gonio::robot::handeye
