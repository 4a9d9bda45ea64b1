// The robot's own noise, from residuals of whole poses: restricted maximum likelihood of two variance components
// (Patterson & Thompson 1971) under residual = J x + e, cov(e) = C_v + rotation^2 R_v + shift^2 S_v per view, by Fisher
// scoring. Private to robot/.
#pragma once
#include <vector>

#include "explain/robot/robot_chain.h"

namespace gonio::explain {

struct NoisyView {
  PoseChange residual;
  Eigen::MatrixXd jacobian;  // 6 x parameters
  PoseMatrix measured;       // covariance of the measurement
  PoseMatrix by_rotation,
      by_shift;  // covariance per unit variance of the robot's rotation (one axis) and position (one coordinate)
  PoseMatrix covariance(double rotation_rad, double shift_m) const {
    return measured + rotation_rad * rotation_rad * by_rotation + shift_m * shift_m * by_shift;
  }
};
struct RobotNoise {
  double rotation_rad = 0, shift_m = 0;
  Eigen::VectorXd estimate;    // of the parameters
  Eigen::MatrixXd covariance;  // of the estimate
  std::vector<bool> outlier;   // views beyond any noise, left out
};
// `prior_precision`: of each parameter about zero, 1 / sigma^2; zero: free.
RobotNoise robot_noise(const std::vector<NoisyView>& views, const Eigen::VectorXd& prior_precision);

}  // namespace gonio::explain
