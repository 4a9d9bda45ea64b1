// ct.scatter on line integrals, and on what filtered back-projection, which is linear, makes of them.
#pragma once
#include <cmath>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& ct_scatter();
}

namespace gonio::equation {

// What the primary beam lost and single scattering spreads: p exp(-p).
inline double ct_scatter_lost(double p) {
  return p * std::exp(-p);
}
// What a line integral p lacks for each share of `scatter`: p + ln(exp(-p) + scatter spread), over scatter; spread: the
// above, spread over the detector.
inline double ct_scatter_lacks(double p, double scatter, double spread) {
  return std::log1p(scatter * std::exp(p) * spread) / scatter;
}
// lacks: the above, or its reconstruction, with `value` accordingly.
inline double ct_scatter(double value, double scatter, double lacks) {
  return value - scatter * lacks;
}

}  // namespace gonio::equation
