// See tables_problem.h. The engine's own fit needs noise and conditions, which are made from this one's predictions.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "explain/tables/tables_problem.h"
#include "linear/solve.h"

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

}  // namespace

std::vector<double> preliminary_fit(const Problem& problem) {
  constexpr int iterations = 60;
  std::vector<double> values;
  for (const Parameter& p : problem.parameters()) values.push_back(p.neutral);
  for (const std::size_t p : problem.base()) values[p] = problem.parameters()[p].start;
  Normal normal = normal_at(problem, values, true);
  double damping = 1e-4;
  for (int i = 0; i < iterations && damping < 1e10; ++i) {
    Eigen::MatrixXd lifted = normal.gram;
    lifted.diagonal() *= 1 + damping;
    lifted.diagonal().array() += 1e-300;
    const Eigen::VectorXd step = linear::solve_ldlt(lifted, normal.gradient);
    std::vector<double> moved = values;
    for (std::size_t k = 0; k < problem.base().size(); ++k) {
      const Parameter& p = problem.parameters()[problem.base()[k]];
      moved[problem.base()[k]] =
          std::clamp(values[problem.base()[k]] + step[static_cast<Eigen::Index>(k)], p.lower, p.upper);
    }
    const double cost = normal_at(problem, moved, false).cost;
    if (!(cost < normal.cost)) {
      damping *= 10;
      continue;
    }
    const bool settled = normal.cost - cost < 1e-9 * normal.cost;
    values = std::move(moved);
    if (settled) break;
    normal = normal_at(problem, values, true);
    damping = std::max(damping / 10, 1e-12);
  }
  return values;
}

}  // namespace gonio::explain::tables
