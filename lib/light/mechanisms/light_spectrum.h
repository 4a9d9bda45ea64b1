// light.spectrum: what red and blue have gained against green since the first recording.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& light_spectrum();
}

namespace gonio::equation {

// `share`: red_share or blue_share; `along`: the time since the first recording over that to the last.
inline double light_spectrum(double share, double along) {
  return 1 + share * along;
}

}  // namespace gonio::equation
