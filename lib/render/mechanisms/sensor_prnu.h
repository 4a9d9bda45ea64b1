// sensor.prnu on one value.
#pragma once
#include <algorithm>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& sensor_prnu();
}

namespace gonio::equation {

// A pixel is blind at worst.
inline double sensor_prnu(double v, double sigma, double normal_of_pixel) {
  return v * std::max(0.0, 1 + sigma * normal_of_pixel);
}

}  // namespace gonio::equation
