// Hand-eye recordings as a problem for the engine. Observations: for every view the six numbers by which the board's
// measured pose differs from the pose through the robot's chain,
//   camera_from_board = (base_from_tool tool_from_camera)^-1 base_from_board    (eye-in-hand)
//   camera_from_board = base_from_camera^-1 base_from_tool tool_from_board      (eye-to-hand),
// whitened by the Cholesky factor of their covariance: the corners' noise through the pose estimate, plus the robot's
// own noise (one standard deviation of position, one of rotation, about the tool), which is estimated from these very
// recordings. One group per view; its six numbers, once
// whitened, are independent witnesses. Score: their root mean square times what one width of that noise moves the
// board's middle by, in metres: the noise was estimated with every hypothesis free, and is no measure of a misfit.
//
// Free in the base model: the two mountings, and focal lengths and principal point where the camera states their sigma
// (as priors). Hypotheses: robot.joint-offset, robot.link-length, robot.sag (they need joints_rad and a known arm),
// board.warp, board.scale and lens terms (they need corners: the measured pose is solved again under each of them).
//
// Frames: tool as the controller reports it; base with z up; board and camera as in camera/board.h. Metres, radians,
// pixels. Pose differences: rotation vector applied on the left, R <- exp([w]x) R, then shift, in the camera's axes,
// about the board's origin. It does not tell robot noise from kinematic errors that no hypothesis describes: both count
// as robot.
#pragma once
#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera/board_projection.h"
#include "explain/engine.h"
#include "inference/explanation.h"
#include "manifest/sections/mounting.h"
#include "robot/kinematics.h"

namespace gonio::explain {

struct RobotInput {
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
  std::vector<robot::Link> links;  // empty: the arm is not known
  std::string camera, board;       // names
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
std::vector<RobotInput> robot_inputs(const manifest::Document& document);

// How the arm came to each pose and passed through it: approach, warmer_K, later_s, velocity and acceleration, from the
// views' joints, times and temperatures.
void find_passage(RobotInput& input);

// What robot, camera and board contribute to the scatter of the board's position, standard deviations in m; and what
// the poses cannot tell apart from the mounting, one sentence each, with the move that separates them.
struct RobotFindings {
  manifest::ScatterParts parts;
  double scatter_m = 0;
  // Noise under the model that stands (robot/handeye/pose_noise.h): one coordinate, one axis; the mountings alone, as
  // handeye has it, unless physics is named.
  double robot_m = 0, robot_rad = 0, board_rad = 0;
  bool with_named = false;
  std::vector<std::string> entangled, next;
  std::string sentence;
};

class RobotProblem : public Problem {
 public:
  virtual RobotFindings findings(const Explanation& explanation) const = 0;
};

std::unique_ptr<RobotProblem> robot_problem(RobotInput input);

}  // namespace gonio::explain
