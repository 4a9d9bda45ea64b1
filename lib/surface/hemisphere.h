// Directions about the local +z: cosine-weighted sampling (Malley's method on the concentric map of Shirley & Chiu
// 1997). density = cos(theta) / pi per steradian.
#pragma once
#include <algorithm>
#include <cmath>

#include "geom/vector.h"

namespace gonio::surface {

inline Vec3 cosine_direction(Vec2 u) {
  const double a = 2 * u.x - 1, b = 2 * u.y - 1;
  if (a == 0 && b == 0) return {0, 0, 1};
  const bool wide = std::abs(a) > std::abs(b);
  const double r = wide ? a : b;
  const double phi = wide ? pi / 4 * (b / a) : pi / 2 - pi / 4 * (a / b);
  const double x = r * std::cos(phi), y = r * std::sin(phi);
  return {x, y, std::sqrt(std::max(0.0, 1 - x * x - y * y))};
}

inline double cosine_density(Vec3 direction) {
  return std::max(0.0, direction.z) / pi;
}

}  // namespace gonio::surface
