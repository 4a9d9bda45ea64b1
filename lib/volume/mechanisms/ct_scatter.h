// ct.scatter on line integrals, and on what filtered back-projection, which is linear, makes of them.
#pragma once
#include <cmath>

#include "mechanism/mechanism.h"
#include "volume/spectrum.h"

namespace gonio::mechanism {
const Mechanism& ct_scatter();
}

namespace gonio::equation {

// What the primary beam lost and single scattering spreads.
inline double ct_scatter_lost(double intensity) {
  return -intensity * std::log(intensity);
}
// What a line integral p lacks for each share of `scatter`; intensity: behind p; spread: the above, spread over the
// detector.
inline double ct_scatter_lacks(double p, double scatter, double intensity, double spread) {
  return (p - volume::line_integral_of(intensity + scatter * spread, volume::usual_variance)) / scatter;
}
// lacks: the above, or its reconstruction, with `value` accordingly.
inline double ct_scatter(double value, double scatter, double lacks) {
  return value - scatter * lacks;
}

}  // namespace gonio::equation
