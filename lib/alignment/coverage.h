// How much of each pixel a region covers that closed rims bound: exactly, without samples. Private to alignment/.
#pragma once
#include <span>
#include <vector>

#include "geom/vector.h"

namespace gonio::alignment {

struct Side {
  Vec2 from, to;
};
// Shares of pixels, whose squares reach half a pixel about their integer centres; sides in any order, the region to
// their left (cross product positive), closed together. What lies beyond the picture counts for nothing. Signed areas
// under each side, summed along rows (the method of font rasterizers: Kallio 2007).
std::vector<float> coverage_of(std::span<const Side> sides, int width, int height);

}  // namespace gonio::alignment
