// The refinement with every view's corners summed up as one observed pose of the board. For sources of this folder
// only.
#pragma once
#include <vector>

#include "robot/handeye/corner_information.h"
#include "robot/handeye/refinement.h"

namespace gonio::robot::handeye {

using Matrix12 = Eigen::Matrix<double, 12, 12>;
using Vector12 = Eigen::Matrix<double, 12, 1>;
using Matrix6x12 = Eigen::Matrix<double, 6, 12>;

struct ObservedPose {
  Rigid<frame::Base, frame::Tool> base_from_tool;
  camera::BoardPose camera_from_board;
  Matrix6 covariance;  // of its changes, columns of camera::moved()
  bool counts = true;
  Vec3 middle_m{};  // of the board
};
// Deviation of the robot's pose that an observed pose implies, [turn; shift], and its derivatives.
struct Deviation {
  Vector6 value;
  Matrix6 by_pose;
  Matrix6x12 by_mountings;
  Eigen::Matrix<double, 6, 3> by_board_turn;  // of the seen board about its middle
};
Deviation deviation(Kind kind, const ObservedPose& observed, const Solution& solution);
Solution moved_by(const Solution& solution, const Vector12& change);

// Covariance of a deviation: the robot's and the camera's.
Matrix6 deviation_covariance(const Deviation& d, const ObservedPose& observed, const Noise& noise);
Matrix12 information(Kind kind, const std::vector<ObservedPose>& observed, const Solution& solution,
                     const Noise& noise);

struct PoseAdjustment {
  Solution solution;
  Noise noise;  // all but corner estimated
  bool converged = false;
};
PoseAdjustment adjust_poses(Kind kind, const std::vector<ObservedPose>& observed, const Solution& start,
                            const Noise& noise);

}  // namespace gonio::robot::handeye
