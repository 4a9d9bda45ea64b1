// Cubic interpolation between evenly spaced values: Catmull & Rom 1974, Keys 1981 with a = -1/2. Exact for polynomials
// of second order, its slope has no steps.
#pragma once
#include <array>

namespace gonio {

// Of the values at -1, 0, 1 and 2, for a place t in 0 to 1. They add up to one.
inline std::array<double, 4> cubic_weights(double t) {
  const double t2 = t * t, t3 = t2 * t;
  return {0.5 * (2 * t2 - t - t3), 0.5 * (3 * t3 - 5 * t2 + 2), 0.5 * (4 * t2 + t - 3 * t3), 0.5 * (t3 - t2)};
}

}  // namespace gonio
