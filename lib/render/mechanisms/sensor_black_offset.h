// sensor.black-offset on one reading.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& sensor_black_offset();
}

namespace gonio::equation {

inline double sensor_black_offset(double v, double offset) {
  return v + offset;
}

}  // namespace gonio::equation
