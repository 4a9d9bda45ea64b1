// ct.blur on the standard deviation of an edge, voxels: variances add up.
#pragma once
#include <cmath>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& ct_blur();
}

namespace gonio::equation {

inline double ct_blur(double width, double spread_voxels) {
  return std::hypot(width, spread_voxels);
}

}  // namespace gonio::equation
