// See bfgs.h.
#include "optim/bfgs.h"

#include <ceres/first_order_function.h>
#include <ceres/gradient_problem.h>
#include <ceres/gradient_problem_solver.h>

#include <cmath>

#include "base/error.h"

namespace gonio::optim {
namespace {

using Eigen::VectorXd;

class Wrapped final : public ceres::FirstOrderFunction {
 public:
  Wrapped(const SlopedFunction& function, Eigen::Index size) : function_(function), size_(static_cast<int>(size)) {}
  bool Evaluate(const double* at, double* cost, double* gradient) const override {
    VectorXd slopes = VectorXd::Zero(size_);
    *cost = function_(Eigen::Map<const VectorXd>(at, size_), gradient == nullptr ? nullptr : &slopes);
    if (gradient != nullptr) Eigen::Map<VectorXd>(gradient, size_) = slopes;
    return std::isfinite(*cost) && slopes.allFinite();
  }
  int NumParameters() const override { return size_; }

 private:
  const SlopedFunction& function_;
  int size_;
};

}  // namespace

Minimum minimise_by_bfgs(const SlopedFunction& function, const VectorXd& start, const Limits& limits) {
  const double first = function(start, nullptr);
  if (!std::isfinite(first)) throw Error(Exit::internal, "optim", "the function has no value at the start");
  ceres::GradientProblemSolver::Options options;
  options.line_search_direction_type = ceres::BFGS;
  options.max_num_iterations = limits.most_steps;
  options.function_tolerance = limits.small_fall.share;
  options.gradient_tolerance = options.parameter_tolerance = 1e-12;
  options.logging_type = ceres::SILENT;
  const ceres::GradientProblem problem(new Wrapped(function, start.size()));
  ceres::GradientProblemSolver::Summary summary;
  Minimum found{start, {}};
  ceres::Solve(options, problem, found.x.data(), &summary);
  found.descended.cost = function(found.x, nullptr);
  if (!(found.descended.cost <= first)) found.x = start, found.descended.cost = first;
  found.descended.steps = static_cast<int>(summary.iterations.size()) - 1;
  found.descended.trials = summary.num_cost_evaluations;
  found.descended.stop = summary.termination_type == ceres::CONVERGENCE      ? Stop::fall
                         : summary.termination_type == ceres::NO_CONVERGENCE ? Stop::steps
                                                                             : Stop::barren;
  return found;
}

}  // namespace gonio::optim
