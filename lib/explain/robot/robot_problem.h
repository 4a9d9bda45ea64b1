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

#include "explain/engine.h"
#include "inference/explanation.h"
#include "manifest/sections/mounting.h"
#include "robot/chain/input.h"

namespace gonio::explain {

using namespace robot;  // the chain, by the names that this domain uses

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

std::unique_ptr<RobotProblem> robot_problem(ChainInput input);

}  // namespace gonio::explain
