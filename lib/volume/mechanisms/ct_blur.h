// ct.blur on the standard deviation of an edge: variances add up. What it does to line integrals: spectrum.h.
#pragma once
#include <cmath>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& ct_blur();
}

namespace gonio::equation {

// Voxels.
inline double ct_blur(double width, double spread_voxels) {
  return std::hypot(width, spread_voxels);
}
}  // namespace gonio::equation
