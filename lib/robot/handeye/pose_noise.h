// The noise of a robot with a camera, from residuals of whole poses: variance components by restricted maximum
// likelihood (Patterson & Thompson, Biometrika 58, 1971) under residual = -J x + e,
//   cov(e) = measured + robot_rad^2 R R' + robot_m^2 S S' + board_rad^2 B B'     per view,
// iterated as by Fellner (Biometrics 42, 1986). R, S: what turns and shifts of the tool about its own origin do to the
// residual; B: what a turn of the seen board about its middle does, beyond the corners' noise. It is the one estimate
// of a robot's noise: the refinement of hand-eye calibration weighs with it, and explain says what it is when physics
// is put in. Left out, the turn of the board would count as shifts of the robot, several times too large.
#pragma once
#include <Eigen/Dense>
#include <array>
#include <vector>

#include "robot/handeye/noise.h"

namespace gonio::robot::handeye {

struct NoisyPose {
  Eigen::Matrix<double, 6, 1> residual;
  Eigen::MatrixXd jacobian;  // 6 x parameters: of the residual
  Eigen::Matrix<double, 6, 6> measured;
  using Effect = Eigen::Matrix<double, 6, 3>;
  Effect by_turn, by_shift, by_board;
  Eigen::Matrix<double, 6, 6> covariance(const Noise& noise) const;
};

struct NoiseStep {
  Eigen::VectorXd change;      // of the parameters: the minimum at the noise before the step
  Eigen::MatrixXd covariance;  // of the parameters
  double moved = 0;            // largest relative change of a standard deviation that matters
};
// Where no component is known: the tool's deviations that would explain the residuals alone.
void begin_noise(const std::vector<NoisyPose>& poses, Noise& noise);

// One update of all components but `corner`. `prior_precision`: of each parameter about where it stands, 1 / sigma^2;
// empty or zero: free. Directions with less than `least_information`, of columns of unit length, stay where they are.
NoiseStep update_noise(const std::vector<NoisyPose>& poses, const Eigen::VectorXd& prior_precision, Noise& noise,
                       double least_information = 1e-12);

// begin_noise(), then updates until nothing moves.
NoiseStep estimate_noise(const std::vector<NoisyPose>& poses, const Eigen::VectorXd& prior_precision, Noise& noise,
                         double least_information = 1e-12);

}  // namespace gonio::robot::handeye
