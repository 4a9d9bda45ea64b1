// Hand-eye recordings of one mounting: for every view the pose of the tool as the controller said it, the pose of the
// board as the camera saw it, and what moved the arm there.
//
// Frames: tool as the controller reports it; base with z up; board and camera as in camera/board.h. Metres, radians,
// pixels.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "camera/board_projection.h"
#include "manifest/sections/forward.h"
#include "robot/kinematics.h"

namespace gonio::robot {

struct ChainInput {
  struct Corner {
    Vec2 board_m, pixel;
    double sigma_px = 0;
  };
  struct View {
    std::string image;
    Rigid<frame::Base, frame::Tool> base_from_tool;
    std::vector<double> joints_rad;    // of every view, or of none
    std::array<double, 6> approach{};  // 1: the joint last turned forwards, -1: backwards, 0: not known
    std::optional<double> time_s{}, temperature_K{};
    double warmer_K = 0, later_s = 0;  // than the mean of the images, where all of them say
    // T(t + dt) = T(t) xi, xi = velocity dt + acceleration dt^2 / 2 as (rotation vector, shift) in the tool's axes.
    std::array<double, 6> velocity{}, acceleration{};
    bool passes = false;  // the neighbours are near enough to know these
    camera::BoardPose camera_from_board;
    std::vector<Corner> corners;                       // of every view, or of none:
    double rotation_sigma_rad = 0, shift_sigma_m = 0;  // then the stated noise of camera_from_board
  };
  std::string mounting, robot;  // names in the manifest's "mountings" and "robots"
  bool eye_to_hand = false;
  // eye-in-hand: tool_from_camera, base_from_board; eye-to-hand: tool_from_board, base_from_camera.
  Rigid<frame::Tool, frame::Object> tool_from_hand;
  Rigid<frame::Base, frame::Object> base_from_fixed;
  std::vector<Link> links;    // empty: the arm is not known
  std::string camera, board;  // names
  camera::Intrinsics intrinsics;
  std::vector<std::size_t> terms;                         // lens terms that the camera has
  std::array<std::optional<double>, 4> pinhole_sigma_px;  // fx fy cx cy
  camera::BoardExtent extent;
  camera::BoardWarp warp;
  bool warped = false;
  std::vector<View> views;
};

// Mountings with both of their poses, and at least six images that have a tool pose (or joints) and
// camera_from_board.
bool has_hand_eye(const manifest::Document& document);
// One for each such mounting. Error(data) in words where a part is missing.
std::vector<ChainInput> robot_inputs(const manifest::Document& document);

// How the arm came to each pose and passed through it: approach, warmer_K, later_s, velocity and acceleration, from the
// views' joints, times and temperatures.
void find_passage(ChainInput& input);

}  // namespace gonio::robot
