// ct.ring on a grey value.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& ct_ring();
}

namespace gonio::equation {

// rings: what pixels of the detector draw at this radius of this slice, of root mean square one.
inline double ct_ring(double value, double ring, double rings) {
  return value + ring * rings;
}

}  // namespace gonio::equation
