// optics.bloom on one value of a picture.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& optics_bloom();
}

namespace gonio::equation {

// `halo`: what the picture without the bloom sends here from all about, render/halo.h.
inline double optics_bloom(double v, double share, double halo) {
  return v + share * (halo - v);
}

}  // namespace gonio::equation
