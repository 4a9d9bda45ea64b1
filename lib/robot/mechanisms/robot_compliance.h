// robot.compliance on where a machine's point is: what carries the arm yields under the arm's weight.
#pragma once
#include <array>

#include "geom/vector.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& robot_compliance();
}

namespace gonio::equation {

// How far a point moves, metres, in the base's axes (z up), when the arm's centre of mass stands at `load_m`: a column
// from `foot_m` up to `height_m` above it, on a floor that yields. With r the horizontal offset of the load from the
// column and t = z x r, the floor tilts by floor t about the foot; a uniform cantilever under an end moment tilts by
// column height t at its end, which moves by height / 2 times that (Gere & Goodno, Mechanics of Materials, table H-1,
// case 6). Both to first order, the numbers for the axes x and y apart; so much as does not change with the load is the
// machine's placement.
struct Yielding {
  double floor_x = 0, floor_y = 0;    // rad per metre of lever, about x and y
  double column_x = 0, column_y = 0;  // rad per metre of lever and metre of height
};
constexpr Vec3 robot_compliance(Vec3 point_m, Vec3 foot_m, Vec3 load_m, double height_m, const Yielding& y) {
  const Vec3 r = load_m - foot_m;
  const Vec3 floor{-y.floor_x * r.y, y.floor_y * r.x, 0};
  const Vec3 column{-y.column_x * r.y * height_m, y.column_y * r.x * height_m, 0};
  const Vec3 up{0, 0, height_m};
  return cross(floor, point_m - foot_m) + cross(column, point_m - foot_m - up) + cross(column, up) * 0.5;
}

}  // namespace gonio::equation
