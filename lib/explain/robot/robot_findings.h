// From recordings to noise and back to words: the work before the engine's (reference poses, noise of robot and
// corners) and after it (parts of the scatter, what is entangled with the mounting, the upgraded sections). Private to
// robot/.
#pragma once
#include <vector>

#include "explain/robot/robot_noise.h"
#include "explain/robot/robot_parameters.h"

namespace gonio::explain {

struct RobotWork {
  ChainInput input;
  RobotParameters parameters;
  std::vector<camera::BoardPose> reference;  // measured poses under the base model, one per view
  std::vector<NoisyView> noisy;              // at the aligned mounting, in the order of the views
  std::vector<double> aligned;               // values of all parameters: mounting aligned, hypotheses neutral
  RobotNoise noise;
  std::vector<std::string> outliers;  // images left out
};

// Solves the measured poses, aligns the mounting, estimates the noise with all hypotheses free (within their plausible
// size, so that they are not taken for noise), and leaves out poses beyond any noise.
void settle(RobotWork& work);

// Of each parameter about its neutral value: hypotheses are free within their typical size, pinhole terms within what
// the camera states, mountings without bound.
Eigen::VectorXd prior_precision(const RobotParameters& parameters);

std::vector<double> start_values(const RobotWork& work);
// Change from the measured to the chain's pose of a view.
PoseChange pose_difference(const RobotWork& work, std::size_t view, const ChainState& state);
// Of a view that is none of the work's, whose measured pose under the base model is `reference`.
PoseChange pose_difference(const RobotWork& work, const ChainInput::View& view, const camera::BoardPose& reference,
                           const ChainState& state);
// Its derivatives: by the chain's parameters (columns of others are zero), and of the measured pose (measured_slopes)
// under `state`.
Eigen::MatrixXd chain_slopes(const RobotWork& work, std::size_t view, std::vector<double> values,
                             std::span<const std::size_t> columns);
Eigen::MatrixXd pose_slopes(const RobotWork& work, std::size_t view, const ChainState& state);

std::vector<Condition> robot_conditions(const RobotWork& work);
void append_robot_conditions(const RobotWork& work, std::size_t view, const PoseMatrix& whitener,
                             std::vector<Condition>& conditions);

// Mean square of the shift of the board's middle by one pose's noise, m^2: what one noise width of a whitened residual
// is worth.
double place_noise2(const RobotWork& work);

RobotFindings findings_of(const RobotWork& work, const std::vector<PoseMatrix>& whitener, const Explanation& e);
void upgrade_robot(const RobotWork& work, const Problem& problem, const RobotFindings& findings, const Explanation& e,
                   manifest::Document& document);
Illustration illustrate_robot(const RobotFindings& findings);

}  // namespace gonio::explain
