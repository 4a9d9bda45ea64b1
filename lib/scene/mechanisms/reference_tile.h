// reference.tile: what a white tile sends back, over what a Lambertian one would.
#pragma once
#include <algorithm>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& reference_tile();
}

namespace gonio::equation {

inline double reference_tile(double incidence, double exitance, double cos_i, double cos_o) {
  const double in = 1 - cos_i, out = 1 - cos_o;
  return std::max(0.0, 1 + incidence * in * in + exitance * out * out);
}

}  // namespace gonio::equation
