// ct.beam-hardening on line integrals, and on what filtered back-projection, which is linear, makes of them.
#pragma once
#include "mechanism/mechanism.h"
#include "volume/spectrum.h"

namespace gonio::mechanism {
const Mechanism& ct_beam_hardening();
}

namespace gonio::equation {

// What a line integral p lacks for each share of hardening, in attenuation lengths like p; longest: the largest line
// integral, of which it is all.
inline double ct_beam_hardening_lacks(double p, double longest) {
  const auto beyond = [](double q) { return q - volume::logarithm_behind(q, volume::usual_variance); };
  return longest * beyond(p) / beyond(longest);
}
// lacks: the above, or its reconstruction, with `value` accordingly.
inline double ct_beam_hardening(double value, double hardening, double lacks) {
  return value - hardening * lacks;
}

}  // namespace gonio::equation
