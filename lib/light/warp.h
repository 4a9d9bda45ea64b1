// Maps from the unit square to discs, spheres and lobes. Directions are local, +z the axis.
#pragma once
#include <algorithm>
#include <cmath>

#include "geom/vector.h"

namespace gonio::light {

// The unit disc, uniformly, neighbours staying neighbours: the concentric map (Shirley & Chiu 1997).
inline Vec2 on_disc(Vec2 u) {
  const double a = 2 * u.x - 1, b = 2 * u.y - 1;
  if (a == 0 && b == 0) return {};
  const bool wide = std::abs(a) > std::abs(b);
  const double r = wide ? a : b, phi = wide ? pi / 4 * (b / a) : pi / 2 - pi / 4 * (a / b);
  return {r * std::cos(phi), r * std::sin(phi)};
}

inline Vec3 at_height(double z, double turn) {  // unit, `turn` in 0 .. 1 about the axis
  const double r = std::sqrt(std::max(0.0, 1 - z * z));
  return {r * std::cos(2 * pi * turn), r * std::sin(2 * pi * turn), z};
}

// All directions, density 1 / (4 pi).
inline Vec3 on_sphere(Vec2 u) {
  return at_height(1 - 2 * u.x, u.y);
}

// Density (exponent + 1) / (2 pi) cos(theta)^exponent over the hemisphere (Lafortune & Willems 1994); exponent 1 is
// Lambert's law.
inline Vec3 on_lobe(Vec2 u, double exponent) {
  return at_height(std::pow(u.x, 1 / (exponent + 1)), u.y);
}

}  // namespace gonio::light
