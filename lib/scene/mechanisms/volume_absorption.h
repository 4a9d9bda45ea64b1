// volume.absorption: the share of the light that comes through a length of the material.
#pragma once
#include <cmath>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& volume_absorption();
}

namespace gonio::equation {

inline double volume_absorption(double sigma_a_per_m, double path_m) {
  return sigma_a_per_m == 0 ? 1 : std::exp(-sigma_a_per_m * path_m);
}

}  // namespace gonio::equation
