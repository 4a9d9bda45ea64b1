// screen.leak on what a screen's section states of its polarization.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& screen_leak();
}

namespace gonio::equation {

inline double screen_leak(double degree, double leak) {
  return degree * (1 - leak) / (1 + leak);
}

}  // namespace gonio::equation
