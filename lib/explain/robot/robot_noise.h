// The robot's own noise and the poses beyond any noise, from residuals of whole poses: the estimate that handeye states
// (robot/handeye/pose_noise.h), with other parameters beside the mountings. Private to robot/.
#pragma once
#include <vector>

#include "explain/robot/pose_matrix.h"
#include "explain/robot/robot_problem.h"
#include "robot/handeye/pose_noise.h"

namespace gonio::explain {

struct NoisyView {
  PoseChange residual;
  Eigen::MatrixXd jacobian;  // 6 x parameters: residual = J x + noise
  robot::handeye::PoseScatter scatter;
  PoseMatrix covariance(const robot::handeye::Noise& noise) const;
};

// `prior_precision`: of each parameter about zero, 1 / sigma^2; zero: free.
robot::handeye::Noise noise_of(const std::vector<NoisyView>& views, const Eigen::VectorXd& prior_precision);

// With every hypothesis free, to weigh by while they are asked. Turns of the seen board are no noise here: lens and
// board make them, whose parameters are free beside it, and a noise of its own would take their signal.
struct RobotNoise {
  robot::handeye::Noise sizes;
  Eigen::VectorXd estimate;   // of the parameters
  std::vector<bool> outlier;  // views beyond any noise, left out
};
RobotNoise robot_noise(const std::vector<NoisyView>& views, const Eigen::VectorXd& prior_precision);

}  // namespace gonio::explain
