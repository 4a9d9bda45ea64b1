// surface.fluorescence: what is sent out at a wavelength per unit of what excites.
#pragma once
#include <cmath>

#include "geom/vector.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& surface_fluorescence();
}

namespace gonio::equation {

inline double surface_fluorescence(double emission, double centre_m, double width_m, double wavelength_m) {
  const double off = (wavelength_m - centre_m) / width_m;
  return emission * std::exp(-0.5 * off * off) / pi;
}

}  // namespace gonio::equation
