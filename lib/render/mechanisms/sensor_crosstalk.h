// sensor.crosstalk on one band of three.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& sensor_crosstalk();
}

namespace gonio::equation {

// `sum` of all bands.
inline double sensor_crosstalk(double v, double share, double sum) {
  return (1 - 3 * share) * v + share * sum;
}

}  // namespace gonio::equation
