// sensor.saturation on one reading.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& sensor_saturation();
}

namespace gonio::equation {

// full_scale 0: no limit.
inline double sensor_saturation(double v, double full_scale) {
  return full_scale > 0 ? std::min(v, full_scale) : v;
}

// What is read on average where noise of one standard deviation `sigma` was there before full scale cut it off: less
// than full scale by 0.4 sigma where just as much light arrives.
//   E min(v + sigma n, F) = F - (F - v) Phi(d) - sigma phi(d),   d = (F - v) / sigma
inline double sensor_saturation_of_noise(double v, double full_scale, double sigma) {
  if (!(full_scale > 0)) return v;
  const double below = full_scale - v, d = sigma > 0 ? below / sigma : 0;
  if (!(sigma > 0) || std::abs(d) > 8) return std::min(v, full_scale);
  return full_scale - below * 0.5 * std::erfc(-d / std::numbers::sqrt2) -
         sigma * std::exp(-0.5 * d * d) * 0.5 * std::numbers::inv_sqrtpi * std::numbers::sqrt2;
}

}  // namespace gonio::equation
