// Joints led to a pose by Newton's method on exact derivatives, damped where the arm stands (nearly) singular.
#pragma once
#include "robot/inverse/screws.h"

namespace gonio::robot::screws {

struct Refined {
  Joints joints_rad{};
  double position_error_m = 0, rotation_error_rad = 0;
};

// Goes on while the error falls: to rounding where the pose is within reach, else to a least of
// (position / size_m)^2 + rotation^2, at most `steps` steps.
Refined refined(const Screws& screws, const Pose& wanted, const Joints& start_rad, int steps);

Refined measured(const Screws& screws, const Pose& wanted, const Joints& joints_rad);

}  // namespace gonio::robot::screws
