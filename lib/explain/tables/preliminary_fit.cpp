// See tables_problem.h. The engine's own fit needs noise and conditions, which are made from this one's predictions.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "explain/tables/tables_problem.h"
#include "optim/damped.h"
#include "optim/descent.h"

namespace gonio::explain::tables {
namespace {

struct Normal {
  Eigen::MatrixXd gram;
  Eigen::VectorXd gradient;
  double cost = 0;
};

Normal normal_at(const Problem& problem, const std::vector<double>& values, bool with_derivatives) {
  const Observations& o = problem.observations();
  const auto n = static_cast<Eigen::Index>(problem.base().size());
  Normal normal{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), 0};
  for (std::size_t g = 0; g < o.groups(); ++g) {
    const std::size_t first = o.first[g], rows = o.first[g + 1] - first;
    Eigen::VectorXd r(static_cast<Eigen::Index>(rows)), w(static_cast<Eigen::Index>(rows));
    problem.predict(values, g, {r.data(), rows});
    for (std::size_t i = 0; i < rows; ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      w[k] = 1 / o.sigma[first + i];
      r[k] = (o.value[first + i] - r[k]) * w[k];
    }
    normal.cost += r.squaredNorm();
    if (!with_derivatives || n == 0) continue;
    Eigen::MatrixXd j(static_cast<Eigen::Index>(rows), n);
    problem.jacobian(values, g, problem.base(), {j.data(), rows * problem.base().size()});
    j = (w.asDiagonal() * j).eval();
    normal.gram += j.transpose() * j;
    normal.gradient += j.transpose() * r;
  }
  return normal;
}

struct Preliminary final : optim::Descent {
  const Problem& problem;
  std::vector<double> values, moved;
  Normal at;

  explicit Preliminary(const Problem& of) : problem(of) {
    for (const Parameter& p : problem.parameters()) values.push_back(p.neutral);
    for (const std::size_t p : problem.base()) values[p] = problem.parameters()[p].start;
  }
  void linearise() override { at = normal_at(problem, values, true); }
  optim::Proposal propose(double damping) override {
    Eigen::VectorXd step = optim::damped_step(at.gram, at.gradient, damping).change;
    moved = values;
    for (std::size_t k = 0; k < problem.base().size(); ++k) {
      const Parameter& p = problem.parameters()[problem.base()[k]];
      double &v = moved[problem.base()[k]], &along = step[static_cast<Eigen::Index>(k)];
      const double from = v;
      v = std::clamp(v + along, p.lower, p.upper);
      along = v - from;  // what bounds have left of it
    }
    return {optim::promised_fall(at.gram, at.gradient, step)};
  }
  double evaluate() override { return normal_at(problem, moved, false).cost; }
  void accept() override { values.swap(moved); }
};

}  // namespace

std::vector<double> preliminary_fit(const Problem& problem) {
  Preliminary preliminary(problem);
  optim::Limits limits;
  limits.most_trials = 60;
  limits.first_damping = 1e-4;
  limits.most_damping = 1e10;
  limits.small_fall = limits.rounding = {1e-9, 0};
  optim::descend(preliminary, normal_at(problem, preliminary.values, false).cost, limits);
  return preliminary.values;
}

}  // namespace gonio::explain::tables
