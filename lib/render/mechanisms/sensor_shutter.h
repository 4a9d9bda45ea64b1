// sensor.shutter on one value.
#pragma once
#include <algorithm>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& sensor_shutter();
}

namespace gonio::equation {

// The shutter stays open `extra_s` longer than was set; a shutter that is too fast for what was set does not open.
inline double sensor_shutter(double v, double extra_s, double exposure_s) {
  return v * std::max(0.0, 1 + extra_s / exposure_s);
}

}  // namespace gonio::equation
