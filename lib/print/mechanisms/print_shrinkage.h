// print.shrinkage: what is printed is smaller than what was sent, about the map's centre.
#pragma once
#include "geom/vector.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& print_shrinkage();
}

namespace gonio::equation {

// From a place of the shrunk print to where it was before; both from the centre.
inline Vec2 print_shrinkage_undone(Vec2 from_centre_m, double x, double y) {
  return {from_centre_m.x / (1 - x), from_centre_m.y / (1 - y)};
}
inline double print_shrinkage(double height_m, double z) {
  return height_m * (1 - z);
}

}  // namespace gonio::equation
