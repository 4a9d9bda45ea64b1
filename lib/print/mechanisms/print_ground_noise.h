// print.ground-noise: heights that the printer adds at random to everything that it makes.
#pragma once
#include <cmath>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& print_ground_noise();
}

namespace gonio::equation {

// Covariance of two heights of one print.
inline double print_ground_noise(double distance_m, double rms_m, double length_m) {
  const double lengths = distance_m / length_m;
  return rms_m * rms_m * std::exp(-0.5 * lengths * lengths);
}

}  // namespace gonio::equation
