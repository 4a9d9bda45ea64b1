// Columns scaled to unit length, so that units do not matter where normal equations are factored.
#pragma once
#include <Eigen/Core>
#include <cmath>

namespace gonio::inference {

// Below this, relative to the unit diagonal of a scaled matrix, a direction carries no information.
inline constexpr double unit_ridge = 1e-13;

// 1 / length, from squared lengths; 0 for columns without any.
inline Eigen::VectorXd unit_scale(const Eigen::VectorXd& squared_lengths) {
  return squared_lengths.unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0.0; });
}

}  // namespace gonio::inference
