// An arm as its axes: the product of exponentials (Brockett 1984). With all joints at zero, joint i turns about the
// line through point[i] along axis[i], both seen in the base, and the flange stands at `zero`; then
//
//   base_from_tool(q) = E_1(q_1) ... E_6(q_6) zero,   E_i(q): turn by q about line i.
//
// Converted from Denavit and Hartenberg's rows, whose frames' origins may lie hundreds of metres out on nearly parallel
// axes: points are slid along their axes to where the arm is, which changes nothing but the rounding.
#pragma once
#include <array>
#include <span>

#include "geom/rigid.h"
#include "robot/inverse/inverse_kinematics.h"

namespace gonio::robot::screws {

struct Pose {  // as a matrix: what the loops multiply
  Mat3 rotation;
  Vec3 position_m;
};
Pose operator*(const Pose& a, const Pose& b);
Pose inverse(const Pose& a);
Pose pose_of(const Rigid<frame::Base, frame::Tool>& rigid);

Mat3 turned(Vec3 axis, double angle_rad);  // Rodrigues

struct Screws {
  std::array<Vec3, 6> axis, point_m;
  Pose zero;
  double size_m = 0;  // sum of the lengths from point to point: what gaps are compared with
};
Screws screws_of(std::span<const Link> six_links);
// The same arm seen from its flange: joints in reverse order, same angles; poses are those of base in tool.
Screws reversed(const Screws& screws);

Pose flange_at(const Screws& screws, const Joints& joints_rad);

struct Motions {
  Pose flange;
  std::array<Vec3, 6> axis;   // where the joints' axes point now
  std::array<Vec3, 6> shift;  // of the flange's origin per radian
};
Motions motions_at(const Screws& screws, const Joints& joints_rad);

struct Miss {
  Vec3 position_m, rotation_rad;  // from where it is to where it should be, in the base
};
Miss miss_of(const Pose& is, const Pose& wanted);

double wrapped(double angle_rad);  // into (-pi, pi]

}  // namespace gonio::robot::screws
