// light.ambient: what even surroundings bring to an open plane.
#pragma once
#include "geom/vector.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& light_ambient();
}

namespace gonio::equation {

inline double light_ambient(double radiance) {
  return pi * radiance;
}

}  // namespace gonio::equation
