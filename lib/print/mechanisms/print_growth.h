// print.growth: a voxel's height by its grey value, in the three numbers that can be read off a wedge.
#pragma once
#include <algorithm>
#include <cmath>

#include "mechanism/mechanism.h"
#include "print/growth.h"

namespace gonio::mechanism {
const Mechanism& print_growth();
}

namespace gonio::equation {

// alpha + beta log(I - gamma), told by the height of white, the darkest grey that cures and the curvature
// k = 1 / (threshold - gamma): h = white log(1 + k (I - threshold)) / log(1 + k (1 - threshold)). In proportion: k ->
// 0.
struct PrintGrowth {
  double white_m = 0, threshold = 0, curvature = 0;
};

inline PrintGrowth print_growth_of(const print::GrowthLaw& law) {
  return {law.height_m(1), law.threshold(), 1 / (law.threshold() - law.gamma)};
}

inline constexpr double straightest = 1e-3;  // curvature, as good as in proportion
inline print::GrowthLaw print_growth(const PrintGrowth& told) {
  const double k = std::max(straightest, told.curvature);
  const double beta_m = told.white_m / std::log1p(k * (1 - told.threshold));
  return {beta_m * std::log(k), beta_m, told.threshold - 1 / k};
}

}  // namespace gonio::equation
