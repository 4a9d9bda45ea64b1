// How much of each pixel the setting covers with a body, or takes of a lamp's light: exact but for a large lamp, which
// is a few dozen places.
#pragma once
#include <vector>

#include "alignment/alignment_input.h"

namespace gonio::alignment {

// Of the picture with its lens' distortion, row by row. `radius_m` of the subject's lamp: of one that is larger than a
// point each pixel has the mean over its places.
std::vector<float> model_region(const AlignmentInput& in, const Setting& setting, const RimSubject& subject,
                                double radius_m = 0);

}  // namespace gonio::alignment
