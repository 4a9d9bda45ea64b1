// light.drift: the output of a lamp that warms up, over that of the warm lamp.
#pragma once
#include <cmath>

namespace gonio::light {

// `since_s`: after the first recording. 1 to the last bit at amplitude 0.
inline double drift(double amplitude, double time_constant_s, double since_s) {
  return 1 + amplitude * std::exp(-since_s / time_constant_s);
}

}  // namespace gonio::light
