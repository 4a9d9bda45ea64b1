// What finding rims in masks does to rims: pixels and smoothing round corners off and pull bends inwards. The aligned
// model's own regions go through the same steps, and what happens to their rims there is taken off those that were
// seen.
#pragma once
#include "alignment/alignment_input.h"

namespace gonio::alignment {

// The question with the bias under `setting` taken off `in`'s rims as they were seen. `radii_m`: of the lamps; one that
// is larger than a point throws a shadow that is the mean of those of all its places, and its rim is where half of it
// is gone. Empty: all are points.
Question without_bias(const AlignmentInput& in, const Setting& setting, const std::vector<double>& radii_m = {});

}  // namespace gonio::alignment
