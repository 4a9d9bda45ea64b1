// Axes of a micro-structure, turned within the surface.
#pragma once
#include <cmath>
#include <numbers>

#include "geom/vector.h"
#include "manifest/model.h"

namespace gonio::relief {

inline manifest::ParameterInfo turn_parameter() {
  return {.name = "turn_rad",
          .unit = "rad",
          .preset = 0.0,
          .lower = -2 * std::numbers::pi,
          .upper = 2 * std::numbers::pi,
          .meaning = "of its axes within the surface, from u towards v"};
}

class Turn {
 public:
  explicit Turn(double rad) : cos_(std::cos(rad)), sin_(std::sin(rad)) {}
  // A place of the surface, along the turned axes.
  Vec2 operator()(Vec2 p) const { return {cos_ * p.x + sin_ * p.y, cos_ * p.y - sin_ * p.x}; }

 private:
  double cos_, sin_;
};

}  // namespace gonio::relief
