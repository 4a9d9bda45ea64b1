// lens.birefringence: how far the light along the radius is delayed behind that across it.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& lens_birefringence();
}

namespace gonio::equation {

// `squared_radius`: over half the picture's width.
inline double lens_birefringence(double retardance_rad, double squared_radius) {
  return retardance_rad * squared_radius;
}

}  // namespace gonio::equation
