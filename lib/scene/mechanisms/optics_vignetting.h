// optics.vignetting: the share of the light that the lens passes at a place of the picture.
#pragma once
#include <algorithm>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& optics_vignetting();
}

namespace gonio::equation {

// `falloff` at half the picture's width. Radius and half width in one unit. No less than nothing passes: a picture
// twice as high as wide ends beyond the circle that a strong falloff leaves.
inline double optics_vignetting(double falloff, double squared_radius, double squared_half_width = 1) {
  return std::max(0.0, 1 - falloff * squared_radius / squared_half_width);
}

}  // namespace gonio::equation
