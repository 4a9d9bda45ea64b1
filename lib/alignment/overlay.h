// A photograph with rims on it, as a drawing. Private to alignment/.
#pragma once
#include <string>
#include <vector>

#include "alignment/alignment_input.h"
#include "io/image.h"

namespace gonio::alignment {

// `picture`: codes (not linear), channels Y or R, G, B; empty: a blank sheet of the camera's size. The model's rims of
// `sightings` under `setting`, objects and shadows in two colours, and over them the seen points that do not count.
std::string overlay_svg(const AlignmentInput& in, const Setting& setting, const std::vector<std::size_t>& sightings,
                        const std::vector<SightingFit>& fits, const io::Image& picture);

}  // namespace gonio::alignment
