// print.overcure: what a layer lets through of the light of later ones (Beer and Lambert).
#pragma once
#include <cmath>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& print_overcure();
}

namespace gonio::equation {

inline double print_overcure(double thickness_m, double depth_m) {
  return depth_m > 0 ? std::exp(-thickness_m / depth_m) : 0;
}

}  // namespace gonio::equation
