// Cells as pictures: one square per cell, as the sample lies upright in its own frame. Cells that do not count are
// grey, defects are framed.
#pragma once
#include "contrast/measure/measure.h"
#include "io/image.h"

namespace gonio::contrast {

io::Image pattern_map(const Measured& measured);                 // bit 1 white
io::Image view_map(const Measured& measured, std::size_t view);  // means, linear up to the 99th percentile, gamma 2.2
io::Image turn_map(const Measured& measured);                    // (before - after) / (before + after); red: positive
double turn_limit(const Measured& measured);                     // full colour of turn_map
io::Image distance_map(const Measured& measured);                // robust distance, up to twice the limit

}  // namespace gonio::contrast
