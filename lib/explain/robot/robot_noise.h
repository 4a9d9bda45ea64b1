// The robot's own noise, from residuals of whole poses: robot/handeye/pose_noise.h, the estimate that handeye states,
// with other parameters beside the mountings where hypotheses are asked; and the poses beyond any noise. Private to
// robot/.
#pragma once
#include <vector>

#include "explain/robot/robot_chain.h"
#include "robot/handeye/pose_noise.h"

namespace gonio::explain {

struct NoisyView {
  PoseChange residual;
  Eigen::MatrixXd jacobian;  // 6 x parameters: residual = J x + noise
  PoseMatrix measured;       // covariance of the measurement
  // What a turn and a shift of the tool, and a turn of the seen board about its middle, do to the residual.
  robot::handeye::NoisyPose::Effect by_turn, by_shift, by_board;
  robot::handeye::NoisyPose pose() const { return {residual, -jacobian, measured, by_turn, by_shift, by_board}; }
  PoseMatrix covariance(const robot::handeye::Noise& noise) const { return pose().covariance(noise); }
};
struct RobotNoise {
  robot::handeye::Noise sizes;
  Eigen::VectorXd estimate;    // of the parameters
  Eigen::MatrixXd covariance;  // of the estimate
  std::vector<bool> outlier;   // views beyond any noise, left out
};
// `prior_precision`: of each parameter about zero, 1 / sigma^2; zero: free.
RobotNoise robot_noise(const std::vector<NoisyView>& views, const Eigen::VectorXd& prior_precision);

}  // namespace gonio::explain
