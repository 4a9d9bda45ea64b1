// Least squares of a dense Model (least_squares.h) by Ceres: its trust region and QR in place of the normal equations,
// which halve the digits of what is badly conditioned. Plain squares, no bounds, no priors. Ceres itself stays in the
// source.
#pragma once
#include <Eigen/Core>

#include "optim/least_squares.h"

namespace gonio::optim {

// Of `limits`: most_steps, small_fall.share, first_damping. Covariance and the reason to stop as fit() has them: `fall`
// stands for any of Ceres' tests of convergence. Error(internal) where the model has no value at `start`.
Fit fit_by_ceres(const Model& model, Eigen::VectorXd start, const Limits& limits = {});

}  // namespace gonio::optim
