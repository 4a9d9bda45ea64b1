// All bodies of an input: each found by itself, then together, then once more without what masks do to rims.
#pragma once
#include <vector>

#include "alignment/align.h"
#include "alignment/alignment_input.h"

namespace gonio::alignment {

// One for each body. Where there are several, they share one fit, whose sightings are in the order of the input's rims.
std::vector<Aligned> align_bodies(const AlignmentInput& in, const AlignWish& wish);
// The input's question without what pixels, smoothing and the lamps' sizes do to rims where these are at `setting`.
Question unbiased(const AlignmentInput& in, const Setting& setting);

}  // namespace gonio::alignment
