// The minimum of a function that is smooth, or nearly, and no sum of squares: BFGS with a line search that keeps
// Wolfe's conditions (Nocedal & Wright, Numerical Optimization, 2nd ed., algorithm 6.1), by Ceres, which stays in the
// source.
#pragma once
#include <Eigen/Core>
#include <functional>

#include "optim/descent.h"

namespace gonio::optim {

// Value at x; `slopes`, of x's size, is to be filled where it is no null pointer. Not finite: no place to be.
using SlopedFunction = std::function<double(const Eigen::VectorXd& x, Eigen::VectorXd* slopes)>;

struct Minimum {
  Eigen::VectorXd x;
  Descended descended;  // cost, steps, why it stopped: `fall` stands for any of Ceres' tests of convergence
};

// Of `limits`: most_steps, small_fall.share. The result is never worse than `start`. Error(internal) where the function
// has no value there.
Minimum minimise_by_bfgs(const SlopedFunction& function, const Eigen::VectorXd& start, const Limits& limits = {});

}  // namespace gonio::optim
