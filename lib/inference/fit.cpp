// See fit.h: the bounded Levenberg-Marquardt iteration.
#include "inference/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"

namespace gonio::inference {
namespace {

double cost_of(const System& system, const std::vector<double>& values, const std::vector<std::size_t>& active) {
  std::vector<double> parts(system.groups.size());
  parallel_for(0, parts.size(),
               [&](std::size_t k) { parts[k] = system.residual(values, system.groups[k]).squaredNorm(); });
  double cost = 0;
  for (const double part : parts) cost += part;
  for (const std::size_t p : active) {
    const Parameter& parameter = system.problem().parameters()[p];
    if (!parameter.prior_sigma) continue;
    const double z = (values[p] - parameter.start) / *parameter.prior_sigma;
    cost += z * z;
  }
  return std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
}

// Columns whose step is not stopped by a bound, given the downhill slope.
std::vector<std::size_t> free_columns(const System& system, const Linearisation& l, const Eigen::VectorXd& slope) {
  std::vector<std::size_t> columns;
  for (std::size_t c = 0; c < l.columns.size(); ++c) {
    const std::size_t place = l.columns[c].parameter;
    const Parameter& p = system.problem().parameters()[place];
    const double v = l.values[place], pull = slope[static_cast<Eigen::Index>(c)];
    if ((v <= p.lower && pull <= 0) || (v >= p.upper && pull >= 0)) continue;
    columns.push_back(c);
  }
  return columns;
}

}  // namespace

Fit fit(const System& system, std::vector<double> start, const std::vector<std::size_t>& active, int iterations,
        const Slopes* kept) {
  Fit result{std::move(start), active, {}, 0, false};
  for (const std::size_t p : active) result.values[p] = system.clamped(p, result.values[p]);
  result.cost = cost_of(system, result.values, active);
  const double tolerance = system.problem().fit_tolerance();
  double damping = 1e-4;
  for (int i = 0; i < iterations && !result.converged; ++i) {
    const Linearisation l = linearise(system, result.values, active, {}, {}, kept);
    std::vector<std::size_t> columns = free_columns(system, l, downhill(l));
    bool accepted = false;
    // Chords that lead nowhere will not do so by being shortened.
    const double most_damping = kept == nullptr ? 1e10 : 1e3 * std::max(damping, 1e-3);
    while (!accepted && damping < most_damping) {
      const NormalEquations equations(l, columns, NormalEquations::none, damping);
      const Eigen::MatrixXd step = equations.solve(equations.gradient());
      std::vector<double> values = result.values;
      for (std::size_t c = 0; c < columns.size(); ++c) {
        const std::size_t p = l.columns[columns[c]].parameter;
        values[p] = system.clamped(p, values[p] + step(static_cast<Eigen::Index>(c), 0));
      }
      const double cost = cost_of(system, values, active);
      accepted = cost < result.cost;
      if (!accepted) {
        // No descent although the step promised less than rounding can show: this is the minimum.
        if (2 * equations.gradient().dot(step.col(0)) < tolerance * result.cost + 1e-9) break;
        damping *= 10;
        continue;
      }
      // A fall of a millionth of one noise unit, or of a billionth of the whole (Problem::fit_tolerance), changes no
      // conclusion.
      result.converged = result.cost - cost < 1e-6 + tolerance * result.cost && damping <= 1e-2;
      result.values = std::move(values);
      result.cost = cost;
      damping = std::max(damping / 10, 1e-12);
    }
    if (!accepted) result.converged = true;
  }
  for (const std::size_t p : active) {
    const Parameter& parameter = system.problem().parameters()[p];
    if (result.values[p] > parameter.lower && result.values[p] < parameter.upper) result.inner.push_back(p);
  }
  return result;
}

double decrement(const System& system, const Fit& fit, const Slopes& slopes) {
  const Linearisation l = linearise(system, fit.values, fit.active, {}, {}, &slopes);
  const std::vector<std::size_t> columns = free_columns(system, l, downhill(l));
  const NormalEquations equations(l, columns, NormalEquations::none, 1e-9);
  return equations.gradient().dot(equations.solve(equations.gradient()).col(0));
}

}  // namespace gonio::inference
