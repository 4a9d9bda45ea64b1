// print.pixel-tilt: the projector is out of focus towards one side of its field.
#pragma once
#include <algorithm>
#include <cmath>

#include "geom/vector.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& print_pixel_tilt();
}

namespace gonio::equation {

// Standard deviation of the spread at a place from the field's corner (0, 0), metres: none at the sharp end.
inline double print_pixel_tilt(Vec2 place_m, Vec2 field_m, double slope_x, double slope_y) {
  return std::abs(slope_x) * (slope_x > 0 ? place_m.x : field_m.x - place_m.x) +
         std::abs(slope_y) * (slope_y > 0 ? place_m.y : field_m.y - place_m.y);
}

}  // namespace gonio::equation
