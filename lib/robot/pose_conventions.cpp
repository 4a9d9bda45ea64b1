// The named conventions of pose lists, and the rotations they mean. Sources: Universal Robots, Script Manual (pose:
// rotation vector, metres); ABB, Technical reference manual RAPID (pos in mm, orient q1..q4 = w x y z; EulerZYX); KUKA,
// Expert Programming (A, B, C about Z, Y', X'', mm, degrees); Fanuc W P R and URDF: fixed axes x, y, z; Staubli, VAL3
// (Rx, Ry', Rz'', mm, degrees).
#include <algorithm>

#include "base/error.h"
#include "geom/angle.h"
#include "robot/pose_list.h"

namespace gonio::robot {
namespace {

constexpr double millimetre = 1e-3;

std::vector<PoseConvention> named() {
  using enum RotationKind;
  return {
      {"matrix", "16 numbers, row-major", "4x4 matrix [R t; 0 0 0 1]; metres", matrix, "", false, 1, 1},
      {"rotation-vector", "x y z rx ry rz", "axis times angle; metres, radians", rotation_vector, "", false, 1, 1},
      {"quaternion-wxyz", "x y z qw qx qy qz", "unit quaternion, scalar first; metres", quaternion_wxyz, "", false, 1,
       1},
      {"quaternion-xyzw", "x y z qx qy qz qw", "unit quaternion, scalar last (ROS); metres", quaternion_xyzw, "", false,
       1, 1},
      {"rpy", "x y z roll pitch yaw", "R = Rz(yaw) Ry(pitch) Rx(roll) (URDF); metres, radians", euler, "xyz", true, 1,
       1},
      {"ur", "x y z rx ry rz", "Universal Robots: rotation vector; metres, radians", rotation_vector, "", false, 1, 1},
      {"abb", "x y z q1 q2 q3 q4", "ABB: unit quaternion, scalar first; millimetres", quaternion_wxyz, "", false,
       millimetre, 1},
      {"abb-euler", "x y z rx ry rz", "ABB EulerZYX: R = Rz(rz) Ry(ry) Rx(rx); millimetres, degrees", euler, "xyz",
       true, millimetre, degree},
      {"kuka", "x y z a b c", "KUKA: R = Rz(a) Ry(b) Rx(c); millimetres, degrees", euler, "zyx", false, millimetre,
       degree},
      {"fanuc", "x y z w p r", "Fanuc: R = Rz(r) Ry(p) Rx(w); millimetres, degrees", euler, "xyz", true, millimetre,
       degree},
      {"staubli", "x y z rx ry rz", "Staubli: R = Rx(rx) Ry(ry) Rz(rz); millimetres, degrees", euler, "xyz", false,
       millimetre, degree},
  };
}

bool is_order(const std::string& axes) {
  return axes.size() == 3 && axes.find_first_not_of("xyz") == std::string::npos && axes[0] != axes[1] &&
         axes[1] != axes[2];
}

double unit_of(const std::string& name, std::initializer_list<std::pair<const char*, double>> units,
               const std::string& place, const char* what) {
  std::string names;
  for (const auto& [unit, factor] : units) {
    if (name == unit) return factor;
    names += std::string(names.empty() ? "" : ", ") + unit;
  }
  throw Error(Exit::usage, place, "\"" + name + "\" is no unit of " + what, "one of " + names);
}

}  // namespace

std::span<const PoseConvention> pose_conventions() {
  static const std::vector<PoseConvention> all = named();
  return all;
}

PoseConvention pose_convention(const std::string& name, const std::string& place) {
  for (const PoseConvention& c : pose_conventions())
    if (c.name == name) return c;
  const bool turned = name.starts_with("euler-"), fixed = name.starts_with("fixed-");
  if ((turned || fixed) && is_order(name.substr(6))) {
    const std::string axes = name.substr(6);
    const std::string columns = std::string("x y z about-") + axes[0] + " about-" + axes[1] + " about-" + axes[2];
    const std::string meaning = std::string("angles about ") + (fixed ? "fixed" : "turned") +
                                " axes in the order of the columns; metres, the angle's unit must be named";
    return {name, columns, meaning, RotationKind::euler, axes, fixed, 1, 0};
  }
  std::string names;
  for (const PoseConvention& c : pose_conventions()) names += c.name + ", ";
  throw Error(Exit::usage, place, "\"" + name + "\" is no convention of poses",
              "one of " + names + "euler-zyx, fixed-xyz and other orders");
}

PoseListFormat pose_list_format(const std::string& convention, const std::string& length, const std::string& angle,
                                const std::string& direction, const std::string& place) {
  PoseListFormat format{pose_convention(convention, place), PoseDirection::base_from_tool};
  PoseConvention& c = format.convention;
  if (!length.empty())
    c.metres_per_length = unit_of(length, {{"m", 1}, {"cm", 1e-2}, {"mm", millimetre}}, place, "length");
  const bool has_angles = c.rotation == RotationKind::euler || c.rotation == RotationKind::rotation_vector;
  if (!angle.empty()) {
    if (!has_angles)
      throw Error(Exit::usage, place, "poses as " + convention + " have no angles", "leave the angle's unit out");
    c.radians_per_angle = unit_of(angle, {{"rad", 1}, {"deg", degree}}, place, "angle");
  }
  if (has_angles && c.radians_per_angle == 0)
    throw Error(Exit::usage, place, convention + " has no unit of angle of its own", "name it: rad or deg");
  if (direction == "tool_from_base")
    format.direction = PoseDirection::tool_from_base;
  else if (direction != "base_from_tool")
    throw Error(Exit::usage, place, "\"" + direction + "\" is no direction of a pose",
                "base_from_tool or tool_from_base");
  return format;
}

Quaternion rotation_of_euler(const std::string& axes, bool fixed_axes, Vec3 angles_rad) {
  Quaternion q;
  for (int i = 0; i < 3; ++i) {
    const char axis = axes[static_cast<std::size_t>(i)];
    const Vec3 vector = Vec3{axis == 'x' ? 1.0 : 0.0, axis == 'y' ? 1.0 : 0.0, axis == 'z' ? 1.0 : 0.0} * angles_rad[i];
    const Quaternion turn = quaternion_of_rotation_vector(vector);
    q = fixed_axes ? turn * q : q * turn;
  }
  return normalized(q);
}

}  // namespace gonio::robot
