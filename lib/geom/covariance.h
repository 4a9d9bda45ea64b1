// Covariances of points, as six numbers: xx, xy, xz, yy, yz, zz.
#pragma once
#include <array>

#include "geom/vector.h"

namespace gonio {

constexpr double variance_along(const std::array<double, 6>& c, Vec3 unit) {
  return unit.x * (c[0] * unit.x + 2 * c[1] * unit.y + 2 * c[2] * unit.z) +
         unit.y * (c[3] * unit.y + 2 * c[4] * unit.z) + c[5] * unit.z * unit.z;
}

constexpr std::array<double, 6> turned_covariance(const Mat3& turn, const std::array<double, 6>& c) {
  const Mat3 v = turn * Mat3{{c[0], c[1], c[2], c[1], c[3], c[4], c[2], c[4], c[5]}} * transposed(turn);
  return {v(0, 0), v(0, 1), v(0, 2), v(1, 1), v(1, 2), v(2, 2)};
}

}  // namespace gonio
