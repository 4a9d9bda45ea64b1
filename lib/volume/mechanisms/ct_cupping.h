// ct.cupping on a value of the material less air: a parabola of the radius.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& ct_cupping();
}

namespace gonio::equation {

// share: the distance from the rotation axis over the radius of the field.
inline double ct_cupping(double value, double cupping, double share) {
  return value * (1 + cupping * (share * share - 0.5));
}

}  // namespace gonio::equation
