// ct.beam-hardening on line integrals, and on what filtered back-projection, which is linear, makes of them.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& ct_beam_hardening();
}

namespace gonio::equation {

// What a line integral p lacks for each share of hardening; longest: the largest line integral.
inline double ct_beam_hardening_lacks(double p, double longest) {
  return p * p / longest;
}
// lacks: the above, or its reconstruction, with `value` accordingly.
inline double ct_beam_hardening(double value, double hardening, double lacks) {
  return value - hardening * lacks;
}

}  // namespace gonio::equation
