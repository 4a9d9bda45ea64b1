// retarder.dispersion on a stated retardance.
#pragma once
#include <cmath>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& retarder_dispersion();
}

namespace gonio::equation {

// `over`: the wavelength at which the retardance is as stated, over that of the light.
inline double retarder_dispersion(double retardance_rad, double order, double over) {
  return order == 0 ? retardance_rad : retardance_rad * std::pow(over, order);
}

}  // namespace gonio::equation
