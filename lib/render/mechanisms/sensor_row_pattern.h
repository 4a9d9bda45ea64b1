// sensor.row-pattern on one value.
#pragma once
#include <cmath>

#include "geom/vector.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& sensor_row_pattern();
}

namespace gonio::equation {

inline double sensor_row_pattern(double v, double amplitude, double period_px, double phase_rad, double row) {
  return v * (1 + amplitude * std::sin(2 * pi * row / period_px + phase_rad));
}

}  // namespace gonio::equation
