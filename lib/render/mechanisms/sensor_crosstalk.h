// sensor.crosstalk on one band of three, or on one sample of a polarization camera.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& sensor_crosstalk();
}

namespace gonio::equation {

// `sum` of all bands; or of a sample and those beside it, `count` in all.
inline double sensor_crosstalk(double v, double share, double sum, double count = 3) {
  return (1 - count * share) * v + share * sum;
}

}  // namespace gonio::equation
