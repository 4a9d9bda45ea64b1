// A projector whose light is a power of what it is told to show: projector.gamma.
#pragma once
#include <cmath>
#include <span>

namespace gonio::equation {

// `shown`: 0 to 1; p: gamma.
inline double projector_gamma(double shown, std::span<const double> p) {
  return p[0] == 1 ? shown : std::pow(shown, p[0]);
}

}  // namespace gonio::equation
