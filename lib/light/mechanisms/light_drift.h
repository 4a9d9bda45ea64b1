// light.drift: the output of a lamp that warms up, over that of the warm lamp.
#pragma once
#include <cmath>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& light_drift();
}

namespace gonio::equation {

// `since_s`: after the first recording. 1 to the last bit at amplitude 0.
inline double light_drift(double amplitude, double time_constant_s, double since_s) {
  return 1 + amplitude * std::exp(-since_s / time_constant_s);
}

}  // namespace gonio::equation
