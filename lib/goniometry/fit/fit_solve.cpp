// See fit_problem.h: the bounded Levenberg-Marquardt iteration. Every trial gathers its normal equations too: most
// trials are accepted, and slopes cost less than a second pass over the rows.
#include <algorithm>
#include <cmath>

#include "goniometry/fit/fit_problem.h"
#include "linear/solve.h"

namespace gonio::goniometry {
namespace {

// Unknowns in the units in which steps are taken: the logarithm where a slot says so.
Eigen::VectorXd units(const Candidate& candidate, const std::vector<double>& x) {
  Eigen::VectorXd unit = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(x.size()));
  for (std::size_t i = 0; i < x.size(); ++i)
    if (slot_of(candidate, i).logarithmic) unit[static_cast<Eigen::Index>(i)] = x[i];
  return unit;
}

double moved(const Slot& slot, double x, double step) {
  if (slot.logarithmic) return std::clamp(x * std::exp(std::clamp(step, -2.0, 2.0)), slot.lower, slot.upper);
  if (slot.periodic) {
    const double period = slot.upper - slot.lower;
    return slot.lower + std::fmod(std::fmod(x + step - slot.lower, period) + period, period);
  }
  return std::clamp(x + step, slot.lower, slot.upper);
}

std::vector<Eigen::Index> free_unknowns(const Candidate& candidate, const std::vector<double>& x, const Normal& at) {
  std::vector<Eigen::Index> free;
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Slot& slot = slot_of(candidate, i);
    const auto k = static_cast<Eigen::Index>(i);
    if (!slot.periodic && ((x[i] <= slot.lower && at.downhill[k] <= 0) || (x[i] >= slot.upper && at.downhill[k] >= 0)))
      continue;
    if (at.h(k, k) > 0) free.push_back(k);
  }
  return free;
}

// Step of the free unknowns in their units, and what it promises to take from the cost.
struct Step {
  Eigen::VectorXd of;
  double promised = 0;
};
Step step_of(const Normal& at, const Eigen::VectorXd& unit, const std::vector<Eigen::Index>& free, double damping) {
  const Eigen::VectorXd scale =
      (at.h.diagonal()(free).array() * unit(free).array().square()).max(1e-300).rsqrt().matrix();
  const Eigen::VectorXd stretch = scale.cwiseProduct(unit(free));
  Eigen::MatrixXd h = stretch.asDiagonal() * at.h(free, free) * stretch.asDiagonal();
  h.diagonal().array() += damping;
  const Eigen::VectorXd g = stretch.cwiseProduct(at.downhill(free)), s = linear::solve_ldlt(h, g);
  return {scale.cwiseProduct(s), 2 * g.dot(s) - s.dot(h * s)};
}

// Above so many rows the way down is gone with few of them, and all of them judge its end.
constexpr std::size_t many_rows = 4000, few_rows = 800;

Rows thinned(const Rows& rows) {
  Rows few(few_rows);
  for (std::size_t k = 0; k < few_rows; ++k) few[k] = rows[k * rows.size() / few_rows];
  return few;
}

}  // namespace

Solution solve(const Problem& problem, const Candidate& candidate, std::vector<double> x, const Rows& rows,
               int iterations) {
  double damping = 1e-3;
  if (rows.size() > many_rows) {
    Solution few = solve(problem, candidate, x, thinned(rows), iterations);
    if (few.converged && std::isfinite(few.at.cost)) x = std::move(few.x), damping = 1e-7;
  }
  for (std::size_t i = 0; i < x.size(); ++i) {
    const Slot& slot = slot_of(candidate, i);
    if (!slot.periodic) x[i] = std::clamp(x[i], slot.lower, slot.upper);
  }
  Solution best{std::move(x), {}, false, 0};
  best.at = problem.normal(candidate, best.x, rows);
  while (best.iterations < iterations && !best.converged) {
    const std::vector<Eigen::Index> free = free_unknowns(candidate, best.x, best.at);
    if (free.empty()) best.converged = true;
    const Eigen::VectorXd unit = units(candidate, best.x);
    bool accepted = free.empty();
    while (!accepted && best.iterations < iterations) {
      ++best.iterations;
      const Step step = step_of(best.at, unit, free, damping);
      if (!(step.promised > 1e-8 * best.at.cost)) {
        best.converged = true;
        break;
      }
      std::vector<double> trial = best.x;
      for (std::size_t k = 0; k < free.size(); ++k) {
        const auto i = static_cast<std::size_t>(free[k]);
        trial[i] = moved(slot_of(candidate, i), trial[i], step.of[static_cast<Eigen::Index>(k)]);
      }
      Normal at = problem.normal(candidate, trial, rows);
      accepted = at.cost < best.at.cost;
      if (!accepted) {
        damping *= 10;
        best.converged = damping > 1e10;
        if (best.converged) break;
        continue;
      }
      best.converged = best.at.cost - at.cost < 1e-8 * best.at.cost && damping <= 1e-2;
      best.x = std::move(trial);
      best.at = std::move(at);
      damping = std::max(damping / 10, 1e-9);
    }
  }
  return best;
}

}  // namespace gonio::goniometry
