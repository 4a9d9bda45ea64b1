// optics.ghost on one value of a picture.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& optics_ghost();
}

namespace gonio::equation {

// `mirrored`: the value of the point opposite about the picture's centre.
inline double optics_ghost(double v, double share, double mirrored) {
  return v + share * mirrored;
}

}  // namespace gonio::equation
