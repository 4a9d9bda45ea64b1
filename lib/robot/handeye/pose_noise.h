// The noise of a robot with a camera, from residuals of whole poses: variance components by restricted maximum
// likelihood (Patterson & Thompson, Biometrika 58, 1971) under
//   residual = -J x + e,   cov(e) = measured + robot_rad^2 R R' + robot_m^2 S S' + board_rad^2 B B'   per view,
// by Newton's method on average information (Gilmour, Thompson & Cullis, Biometrics 51, 1995). R, S: what turns and
// shifts of the tool about its own origin do to the residual; B: what a turn of the seen board about its middle does,
// beyond the corners' noise. Left out where such turns are, they count as shifts of the robot, several times too large.
// It is the one estimate of a robot's noise: the refinement of hand-eye calibration weighs by it, and explain says by
// it what noise is left beside the physics that it names.
//
// Vectors and matrices are plain numbers, column by column; residuals, their axes and units are the caller's.
#pragma once
#include <array>
#include <span>
#include <vector>

#include "robot/handeye/noise.h"

namespace gonio::robot::handeye {

// How one residual scatters. An effect that is zero in all of them is no component: its deviation comes out as zero.
struct PoseScatter {
  using Effect = std::array<double, 18>;  // 6 x 3
  std::array<double, 36> measured{};
  Effect by_turn{}, by_shift{}, by_board{};
  std::array<double, 36> covariance(const Noise& noise) const;
};
struct NoisyPose {
  std::array<double, 6> residual{};
  std::vector<double> jacobian;  // 6 x parameters: of the residual
  PoseScatter scatter;
};

// Generalised least squares at a noise. `prior_precision`: of each parameter about where it stands, 1 / sigma^2; zero:
// free; none: all are free. Directions of which the poses say nothing stay where they are, whatever the prior.
using Precision = std::span<const double>;
struct PoseFit {
  std::vector<double> change, information;  // of the parameters
};
PoseFit fit_poses(const std::vector<NoisyPose>& poses, const Noise& noise, Precision prior_precision = {});

// Where nothing is known of the robot's noise: the tool's deviations that would explain the residuals alone.
void begin_noise(const std::vector<NoisyPose>& poses, Noise& noise);

// One step of all components but `corner`, at a fixed linearisation; one that is zero stays so. Returned: its length in
// standard errors of the variances.
double update_noise(const std::vector<NoisyPose>& poses, Noise& noise, Precision prior_precision = {});

// begin_noise(), then steps until nothing moves.
Noise estimate_noise(const std::vector<NoisyPose>& poses, const Noise& start = {}, Precision prior_precision = {});

}  // namespace gonio::robot::handeye
