// What hand-eye calibration starts from: at every pose of a robot, what its controller said and what its camera saw.
//
// Both arrangements are one equation. A camera sits on a `Mount` and looks at a board that sits on a `Stand`; the robot
// moves the one against the other:
//   eye-in-hand: the mount is the tool, the stand the base;   stand_from_mount = base_from_tool
//   eye-to-hand: the mount is the base, the stand the tool;   stand_from_mount = tool_from_base
//   stand_from_mount * mount_from_camera * camera_from_board = stand_from_board          at every pose.
// With A = stand_from_mount, X = mount_from_camera, B = board_from_camera, Z = stand_from_board this is A X = Z B, and
// for motions between two poses, Z eliminated, A X = X B. Lengths are metres.
#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "geom/rigid.h"

namespace gonio::robot::handeye {

struct Mount {};
struct Stand {};

enum class Kind { eye_in_hand, eye_to_hand };
std::string_view name_of(Kind kind);  // as manifest::Mounting::kind

struct PoseSample {
  Rigid<Stand, Mount> stand_from_mount;
  Rigid<frame::Camera, frame::Board> camera_from_board;
};
PoseSample sample_of(Kind kind, const Rigid<frame::Base, frame::Tool>& base_from_tool,
                     const Rigid<frame::Camera, frame::Board>& camera_from_board);

struct Solution {
  Rigid<Mount, frame::Camera> mount_from_camera;
  Rigid<Stand, frame::Board> stand_from_board;
};

// Where the board stands according to one sample.
Rigid<Stand, frame::Board> board_seen(const PoseSample& sample, const Rigid<Mount, frame::Camera>& mount_from_camera);

struct PoseError {
  double translation_m = 0, rotation_rad = 0;
};
// Between two poses of the board: distance that its point `middle_m` moves, and the angle.
PoseError difference(const Rigid<Stand, frame::Board>& a, const Rigid<Stand, frame::Board>& b, Vec3 middle_m);

// Root mean squares over samples of the board's place against the solution's; `middle_m` is where the place is taken.
PoseError scatter(std::span<const PoseSample> samples, const Solution& solution, Vec3 middle_m);

}  // namespace gonio::robot::handeye
