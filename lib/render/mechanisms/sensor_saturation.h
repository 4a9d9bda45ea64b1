// sensor.saturation on one reading.
#pragma once
#include <algorithm>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& sensor_saturation();
}

namespace gonio::equation {

// full_scale 0: no limit.
inline double sensor_saturation(double v, double full_scale) {
  return full_scale > 0 ? std::min(v, full_scale) : v;
}

}  // namespace gonio::equation
