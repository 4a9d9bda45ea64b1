// See fit.h: the bounded Levenberg-Marquardt iteration.
#include "inference/fit.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "optim/descent.h"

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

struct Bounded final : optim::Descent {
  const System& system;
  const std::vector<std::size_t>& active;
  const Slopes* kept;
  std::vector<double> values, moved;
  Linearisation at;
  std::vector<std::size_t> columns;

  Bounded(const System& of, const std::vector<std::size_t>& free, const Slopes* chords, std::vector<double> start)
      : system(of), active(free), kept(chords), values(std::move(start)) {
    for (const std::size_t p : active) values[p] = system.clamped(p, values[p]);
  }
  void linearise() override {
    at = inference::linearise(system, values, active, {}, {}, kept);
    columns = free_columns(system, at, downhill(at));
  }
  optim::Proposal propose(double damping) override {
    const NormalEquations equations(at, columns, NormalEquations::none, damping);
    Eigen::VectorXd step = equations.solve(equations.gradient()).col(0);
    moved = values;
    bool cut = false;
    for (std::size_t c = 0; c < columns.size(); ++c) {
      const std::size_t p = at.columns[columns[c]].parameter;
      double& along = step[static_cast<Eigen::Index>(c)];
      moved[p] = system.clamped(p, values[p] + along);
      if (moved[p] == values[p] + along) continue;
      along = moved[p] - values[p];
      cut = true;
    }
    if (cut) return {promised_fall(at, columns, step)};
    return {equations.gradient().dot(step) + damping * step.dot(equations.diagonal().cwiseProduct(step))};
  }
  double evaluate() override { return cost_of(system, moved, active); }
  void accept() override { values.swap(moved); }
};

}  // namespace

Fit fit(const System& system, std::vector<double> start, const std::vector<std::size_t>& active, int iterations,
        const Slopes* kept) {
  Bounded bounded(system, active, kept, std::move(start));
  const double tolerance = system.problem().fit_tolerance();
  optim::Limits limits;
  limits.most_steps = iterations;
  limits.first_damping = 1e-4;
  limits.most_damping = 1e10;
  if (kept != nullptr) limits.most_refusals = 5;  // chords that lead nowhere will not do so by being shortened
  // A fall of a millionth of one noise unit, or of a billionth of the whole (Problem::fit_tolerance), changes no
  // conclusion.
  limits.small_fall = {tolerance, 1e-6};
  limits.calm_damping = 1e-2;
  limits.rounding = {tolerance, 1e-9};
  const optim::Descended end = optim::descend(bounded, cost_of(system, bounded.values, active), limits);
  Fit result{std::move(bounded.values), active, {}, end.cost, end.stop != optim::Stop::steps};
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
