// Axes of a micro-structure, turned within the surface, and by a right angle further where a picture is white: cells of
// a code, or a face, that shine at different turns of the sample.
#pragma once
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "geom/vector.h"
#include "relief/microstructure.h"

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

inline manifest::ParameterInfo cell_parameter() {
  return {.name = "cell_m",
          .unit = "m",
          .preset = 0.0,
          .lower = 0,
          .upper = 1,
          .meaning = "with a file: size of the picture's pixels on the surface, its middle at the origin of u and v"};
}
inline constexpr const char* cells_meaning =
    "a picture, rows along u and against v; where it is white, the axes are turned by a right angle";

// Value from 0 to 1 of the pixel (x, y), rows from the top; `beyond` outside of the picture.
double pixel_share(const io::GreyImage& picture, int x, int y, double beyond);
// Place of a surface in pixels of a picture whose middle lies at the origin.
Vec2 in_pixels(const io::GreyImage& picture, Vec2 along_m, double pixel_m);

class TurnByCells {
 public:
  // Without a picture turned by `rad` alone. Error(data) at `place` for a picture without a cell's size.
  TurnByCells(double rad, const io::GreyImage* picture, double cell_m, const std::string& place);
  Vec2 operator()(Vec2 p) const;

 private:
  Turn turn_;
  const io::GreyImage* picture_;
  double cell_m_;
};

}  // namespace gonio::relief
