// optics.veiling-glare on one value of a picture.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& optics_veiling_glare();
}

namespace gonio::equation {

// The mean is that of the picture's channel without the veil.
inline double optics_veiling_glare(double v, double share, double mean_of_picture) {
  return v + share * mean_of_picture;
}

}  // namespace gonio::equation
