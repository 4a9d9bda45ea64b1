// The pose of the board in the camera by two ways, and how noise of the robot moves it.
//
// Changes of pose are six numbers, rotation vector (left, camera's axes, rad) then shift (m), as in camera::moved.
//
// The tool's pose under a state: flange(links + changes, joints + offsets + s backlash / 2 + yielding) in place of the
// nominal flange (s the sign of approach), then moved on along its path by the lag, then its position scaled by the
// growth of the links: with all a_i and d_i times a factor, the flange's position is times this factor.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "robot/chain/input.h"

namespace gonio::robot {

using Change = std::array<double, 6>;         // of a pose
using ChangeMatrix = std::array<double, 36>;  // changes by changes, column by column

// What the hypotheses move, at one point of the parameter space.
struct ChainState {
  std::array<double, 6> hand{}, fixed{};  // changes of the two mountings
  std::array<double, 6> joint_rad{}, a_m{}, d_m{};
  std::array<double, 2> sag_rad_per_m{};  // joints 2 and 3
  std::array<double, 6> backlash_rad{};
  double growth_per_K = 0, growth_per_s = 0, lag_s = 0;
  camera::Intrinsics intrinsics;
  camera::BoardWarp warp;
  std::array<double, 2> scale{};
};

// change such that `moved(from, change)` is `to`.
Change change_between(const camera::BoardPose& from, const camera::BoardPose& to);

// The flange by the state's kinematics. `approach`: for each joint 1 where it last turned forwards, -1 where backwards;
// empty: no backlash.
Rigid<frame::Base, frame::Tool> corrected_flange(std::vector<Link> links, std::vector<double> joints_rad,
                                                 std::span<const double> approach, const ChainState& state);

// The tool pose as the controller said, corrected by the state's kinematics, base_from_tool = flange(state)
// flange(nominal)^-1 given.
Rigid<frame::Base, frame::Tool> tool_pose(const ChainInput& input, const ChainInput::View& view,
                                          const ChainState& state);

// camera_from_board through the robot.
camera::BoardPose chain_pose(const ChainInput& input, const ChainInput::View& view, const ChainState& state);

// Derivative of the chain's pose by a change of the tool's pose, T <- T exp(xi), xi = (rotation, shift) in the tool's
// axes.
ChangeMatrix by_tool(const ChainInput& input, const ChainInput::View& view, const ChainState& state);

struct MeasuredPose {
  camera::BoardPose camera_from_board;
  ChangeMatrix covariance{};        // from the corners' stated noise
  double squares = 0, freedom = 0;  // of the corners' residuals in units of that noise; numbers beyond the pose's six
};
// Least squares over the view's corners (Gauss-Newton), from `start`; views without corners keep their pose.
MeasuredPose measured_pose(const ChainInput::View& view, const ChainInput& input, const ChainState& state,
                           const camera::BoardPose& start, int iterations);

// Derivatives of the measured pose by what moves it, at `pose`, by the implicit function theorem (Gauss-Newton's
// Hessian): six rows, column by column those of `pinhole` (4), lens terms, warp (2) and scale (2). Corners only.
std::vector<double> measured_slopes(const ChainInput::View& view, const ChainInput& input, const ChainState& state,
                                    const camera::BoardPose& pose);
inline constexpr std::size_t slope_distortion = 4;
inline constexpr std::size_t slope_warp = slope_distortion + camera::distortion_terms, slope_scale = slope_warp + 2;

}  // namespace gonio::robot
