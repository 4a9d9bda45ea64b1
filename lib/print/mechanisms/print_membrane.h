// print.membrane: tops are cut below the top of their layer.
#pragma once
#include <algorithm>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& print_membrane();
}

namespace gonio::equation {

inline double print_membrane(double top_m, double layer_top_m, double cut_m) {
  return std::min(top_m, layer_top_m - cut_m);
}

}  // namespace gonio::equation
