// The direction in which a printer stacks its layers: two angles in the object frame, for laws of printed surfaces.
#pragma once
#include <cmath>
#include <vector>

#include "geom/vector.h"
#include "manifest/model.h"

namespace gonio::surface {

inline Vec3 print_direction(double polar_rad, double azimuth_rad) {
  const double across = std::sin(polar_rad);
  return {across * std::cos(azimuth_rad), across * std::sin(azimuth_rad), std::cos(polar_rad)};
}

// `own`, followed by the two angles.
inline std::vector<manifest::ParameterInfo> with_print_direction(std::vector<manifest::ParameterInfo> own) {
  own.push_back({.name = "polar_rad",
                 .unit = "rad",
                 .preset = 0,
                 .lower = 0,
                 .upper = pi,
                 .meaning = "angle between the print direction and the object's z axis"});
  own.push_back({.name = "azimuth_rad",
                 .unit = "rad",
                 .preset = 0,
                 .lower = -2 * pi,
                 .upper = 2 * pi,
                 .meaning = "azimuth of the print direction about the object's z axis, from x towards y"});
  return own;
}

}  // namespace gonio::surface
