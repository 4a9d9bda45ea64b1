// Standard deviations of a pose from the covariance of a small motion about another point.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>

#include "manifest/pose.h"

namespace gonio::manifest {

// `covariance`: 6 x 6, row by row, of a rotation vector (rad) and a shift (m) at some point; `arm_m` leads from there
// to the pose's origin, whose shift is that of the point and what the turn about it adds.
inline PoseSigma sigma_at(std::span<const double, 36> covariance, Vec3 arm_m) {
  const std::array<std::array<double, 3>, 3> of_turn{
      {{0, arm_m.z, -arm_m.y}, {-arm_m.z, 0, arm_m.x}, {arm_m.y, -arm_m.x, 0}}};
  PoseSigma sigma;
  for (std::size_t k = 0; k < 3; ++k) {
    std::array<double, 6> row{};
    for (std::size_t j = 0; j < 3; ++j) row[j] = of_turn[k][j];
    row[3 + k] = 1;
    double variance = 0;
    for (std::size_t i = 0; i < 6; ++i)
      for (std::size_t j = 0; j < 6; ++j) variance += row[i] * covariance[6 * i + j] * row[j];
    sigma.rotation_rad.push_back(std::sqrt(std::max(0.0, covariance[7 * k])));
    sigma.translation_m.push_back(std::sqrt(std::max(0.0, variance)));
  }
  return sigma;
}

}  // namespace gonio::manifest
