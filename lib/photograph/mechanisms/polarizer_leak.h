// polarizer.leak on what a polarizer passes.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& polarizer_leak();
}

namespace gonio::equation {

// `along`: what an ideal polarizer passes; `across`: what it absorbs.
inline double polarizer_leak(double along, double across, double leak) {
  return along + leak * across;
}

}  // namespace gonio::equation
