// surface.spatial-variation: the factor of a stain on the albedo at a place of the object's frame, m.
#pragma once
#include <algorithm>
#include <cmath>

#include "geom/vector.h"

namespace gonio::surface {

// 1 to the last bit at depth 0; never below 0.
inline double stain(Vec3 position_m, Vec3 middle_m, double width_m, double depth) {
  const Vec3 d = position_m - middle_m;
  return std::max(0.0, 1 + depth * std::exp(-dot(d, d) / (2 * width_m * width_m)));
}

}  // namespace gonio::surface
