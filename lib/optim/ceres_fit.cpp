// See ceres_fit.h.
#include "optim/ceres_fit.h"

#include <ceres/cost_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/solver.h>

#include <algorithm>

#include "base/error.h"

namespace gonio::optim {
namespace {

using Eigen::Index;
using Eigen::VectorXd;
using Row = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

// Slopes where they were asked for last are not worked out again: where Ceres ends it has asked for them.
class Remembering final : public Model {
 public:
  explicit Remembering(const Model& model) : model_(model) {}
  bool residuals(const VectorXd& x, VectorXd& r) const override { return model_.residuals(x, r); }
  Index freedoms(const VectorXd& x) const override { return model_.freedoms(x); }
  VectorXd moved(const VectorXd& x, const VectorXd& change) const override { return model_.moved(x, change); }
  double difference(const VectorXd& x, Index k) const override { return model_.difference(x, k); }
  Eigen::MatrixXd slopes(const VectorXd& x, const VectorXd& r) const override {
    if (x_.size() != x.size() || x_ != x) {
      slopes_ = model_.slopes(x, r);
      x_ = x;
    }
    return slopes_;
  }

 private:
  const Model& model_;
  mutable VectorXd x_;
  mutable Eigen::MatrixXd slopes_;
};

// Ceres multiplies slopes by parameters with the derivative of moved() at no change. A model states slopes by change:
// they stand in the first columns, and that derivative is [1; 0].
class Changes final : public ceres::Manifold {
 public:
  Changes(const Model& model, const VectorXd& start)
      : model_(model), size_(start.size()), freedoms_(model.freedoms(start)) {}
  int AmbientSize() const override { return static_cast<int>(size_); }
  int TangentSize() const override { return static_cast<int>(freedoms_); }
  bool Plus(const double* x, const double* change, double* moved) const override {
    Eigen::Map<VectorXd>(moved, size_) =
        model_.moved(Eigen::Map<const VectorXd>(x, size_), Eigen::Map<const VectorXd>(change, freedoms_));
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Row>(jacobian, size_, freedoms_).setIdentity();
    return true;
  }
  bool Minus(const double*, const double*, double*) const override { return false; }  // no solver here asks
  bool MinusJacobian(const double*, double*) const override { return false; }

 private:
  const Model& model_;
  Index size_, freedoms_;
};

class Whole final : public ceres::CostFunction {
 public:
  Whole(const Model& model, const VectorXd& start, Index rows) : model_(model), size_(start.size()) {
    set_num_residuals(static_cast<int>(rows));
    mutable_parameter_block_sizes()->push_back(static_cast<int>(size_));
  }
  bool Evaluate(double const* const* blocks, double* residuals, double** jacobians) const override {
    const VectorXd x = Eigen::Map<const VectorXd>(blocks[0], size_);
    VectorXd r;
    if (!model_.residuals(x, r)) return false;
    Eigen::Map<VectorXd>(residuals, r.size()) = r;
    if (jacobians == nullptr || jacobians[0] == nullptr) return true;
    const Eigen::MatrixXd j = model_.slopes(x, r);
    Eigen::Map<Row> all(jacobians[0], r.size(), size_);
    all.setZero();
    all.leftCols(j.cols()) = j;
    return true;
  }

 private:
  const Model& model_;
  Index size_;
};

ceres::Solver::Options options_of(const Limits& limits) {
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::DENSE_QR;
  options.max_num_iterations = limits.most_steps;
  options.function_tolerance = limits.small_fall.share;
  options.gradient_tolerance = options.parameter_tolerance = 1e-15;
  options.initial_trust_region_radius = 1 / std::max(limits.first_damping, 1e-16);
  options.logging_type = ceres::SILENT;
  return options;
}

}  // namespace

Fit fit_by_ceres(const Model& fitted, VectorXd start, const Limits& limits) {
  const Remembering model(fitted);
  VectorXd r;
  if (!model.residuals(start, r)) throw Error(Exit::internal, "optim", "the model has no value at the start");
  if (model.freedoms(start) > start.size())
    throw Error(Exit::internal, "optim", "the model has more freedoms than parameters");
  Changes changes(model, start);
  Whole whole(model, start, r.size());
  ceres::Problem::Options owned;
  owned.cost_function_ownership = owned.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  ceres::Problem problem(owned);
  problem.AddParameterBlock(start.data(), static_cast<int>(start.size()), &changes);
  problem.AddResidualBlock(&whole, nullptr, start.data());
  ceres::Solver::Summary summary;
  ceres::Solve(options_of(limits), &problem, &summary);
  Limits none;
  none.most_steps = 0;
  Fit result = fit(model, std::move(start), {}, none);
  result.descended.steps = summary.num_successful_steps;
  result.descended.trials = summary.num_successful_steps + summary.num_unsuccessful_steps;
  result.descended.stop = summary.termination_type == ceres::CONVERGENCE      ? Stop::fall
                          : summary.termination_type == ceres::NO_CONVERGENCE ? Stop::steps
                                                                              : Stop::barren;
  return result;
}

}  // namespace gonio::optim
