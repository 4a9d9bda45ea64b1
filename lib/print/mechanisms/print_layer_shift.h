// print.layer-shift: from one layer on all pictures fall beside where they should.
#pragma once
#include "geom/vector.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& print_layer_shift();
}

namespace gonio::equation {

// Of layer k, the first on the platform being 1, metres on the platform.
inline Vec2 print_layer_shift(double layer, double from_layer, double x_m, double y_m) {
  return layer >= from_layer ? Vec2{x_m, y_m} : Vec2{0, 0};
}

}  // namespace gonio::equation
