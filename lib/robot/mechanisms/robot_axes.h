// robot.axis-scale and robot.squareness on where a machine's point is.
#pragma once
#include "geom/vector.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& robot_axis_scale();
const Mechanism& robot_squareness();
}  // namespace gonio::mechanism

namespace gonio::equation {

constexpr Vec3 robot_axis_scale(Vec3 point_m, Vec3 share) {
  return {point_m.x * (1 + share.x), point_m.y * (1 + share.y), point_m.z * (1 + share.z)};
}

// y leans towards x by xy, z towards x by xz and towards y by yz: positive where the angle between the axes is below 90
// degrees. x and the plane of x and y are the reference.
constexpr Vec3 robot_squareness(Vec3 point_m, double xy, double xz, double yz) {
  return {point_m.x + xy * point_m.y + xz * point_m.z, point_m.y + yz * point_m.z, point_m.z};
}

}  // namespace gonio::equation
