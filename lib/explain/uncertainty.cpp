// See fit.h: covariance, intervals and the test of "neutral".
#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "explain/fit.h"
#include "stats/distributions.h"

namespace gonio::explain {
namespace {

constexpr double many = 1e6;  // degrees of freedom of a normal law

// Sum over blocks of u u', u = J'r of the block; parameters the group does not touch stay zero.
Eigen::MatrixXd block_scores(const System& system, const Fit& fit, const Slopes* kept) {
  const auto n = static_cast<Eigen::Index>(fit.inner.size());
  const Observations& o = system.observations();
  std::vector<Eigen::MatrixXd> parts(system.groups.size());
  parallel_for(0, parts.size(), [&](std::size_t k) {
    const std::size_t group = system.groups[k];
    std::vector<std::size_t> parameters;
    std::vector<Eigen::Index> places;
    for (std::size_t c = 0; c < fit.inner.size(); ++c) {
      if (!system.touches(fit.inner[c], group)) continue;
      parameters.push_back(fit.inner[c]);
      places.push_back(static_cast<Eigen::Index>(c));
    }
    const Eigen::MatrixXd j = system.jacobian(fit.values, group, parameters, kept);
    const Eigen::VectorXd r = system.residual(fit.values, group);
    std::map<std::uint32_t, Eigen::VectorXd> blocks;
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      auto& u =
          blocks.try_emplace(o.block[o.first[group] + static_cast<std::size_t>(i)], Eigen::VectorXd::Zero(j.cols()))
              .first->second;
      u += j.row(i).transpose() * r[i];
    }
    Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(j.cols(), j.cols());
    for (const auto& [block, u] : blocks) sum.noalias() += u * u.transpose();
    parts[k] = Eigen::MatrixXd::Zero(n, n);
    parts[k](places, places) = sum;
  });
  Eigen::MatrixXd total = Eigen::MatrixXd::Zero(n, n);
  for (const Eigen::MatrixXd& part : parts) total += part;
  return total;
}

// Variance of each parameter from leaving out one group at a time (one Gauss-Newton step each); zero where it is not
// shared.
Eigen::VectorXd jackknife(const System& system, const Linearisation& l, const std::vector<std::size_t>& columns) {
  const auto n = static_cast<Eigen::Index>(columns.size());
  const auto groups = static_cast<Eigen::Index>(l.grams.size());
  Eigen::MatrixXd steps(n, groups);
  parallel_for(0, l.grams.size(), [&](std::size_t g) {
    const NormalEquations equations(l, columns, l.grams[g].group);
    steps.col(static_cast<Eigen::Index>(g)) = equations.solve(equations.gradient());
  });
  const Eigen::VectorXd centre = steps.rowwise().mean();
  Eigen::VectorXd variance = (steps.colwise() - centre).rowwise().squaredNorm();
  variance *= static_cast<double>(groups - 1) / static_cast<double>(std::max<Eigen::Index>(groups, 1));
  for (Eigen::Index c = 0; c < n; ++c) {
    // Acting on fewer than five groups, a parameter has no jackknife worth the name.
    const std::vector<std::size_t>& on =
        system.problem().parameters()[l.columns[columns[static_cast<std::size_t>(c)]].parameter].groups;
    if (groups < 5 || (!on.empty() && on.size() < 5)) variance[c] = 0;
  }
  return variance;
}

}  // namespace

Uncertainty uncertainty(const System& system, const Fit& fit, const Slopes* kept) {
  Slopes own;
  own = slopes(system, fit.values, fit.inner, kept);  // taken once, used twice
  kept = &own;
  Uncertainty u;
  u.parameters = fit.inner;
  const auto n = static_cast<Eigen::Index>(fit.inner.size());
  u.degrees.assign(fit.inner.size(), many);
  if (n == 0) return u;
  const Linearisation l = linearise(system, fit.values, fit.inner, {}, {}, kept);
  std::vector<std::size_t> columns(fit.inner.size());
  for (std::size_t c = 0; c < columns.size(); ++c) columns[c] = c;
  const NormalEquations equations(l, columns);
  const Eigen::MatrixXd inverse = equations.solve(Eigen::MatrixXd::Identity(n, n));
  double rows = 0;
  for (const std::size_t g : system.groups) rows += static_cast<double>(system.used_rows(g));
  const double correction = rows / std::max(rows - static_cast<double>(n), 1.0);
  Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index c = 0; c < n; ++c) prior(c, c) = l.columns[static_cast<std::size_t>(c)].prior_precision;
  u.covariance = inverse * (block_scores(system, fit, kept) * correction + prior) * inverse.transpose();
  const Eigen::VectorXd by_groups = jackknife(system, l, columns);
  const double degrees = static_cast<double>(system.groups.size()) - 1;
  const double limit = degrees > 0 ? stats::chi2_quantile(0.95, degrees) / degrees : 1;
  Eigen::VectorXd stretch = Eigen::VectorXd::Ones(n);
  for (Eigen::Index c = 0; c < n; ++c) {
    const double variance = u.covariance(c, c);
    if (!(variance > 0) || by_groups[c] < limit * variance) continue;
    stretch[c] = std::sqrt(by_groups[c] / variance);
    u.degrees[static_cast<std::size_t>(c)] = degrees;
  }
  u.covariance = stretch.asDiagonal() * u.covariance * stretch.asDiagonal();
  return u;
}

std::vector<Estimate> estimates(const System& system, const Fit& fit, const Uncertainty& u,
                                const std::vector<std::size_t>& parameters) {
  std::vector<Estimate> result;
  for (const std::size_t p : parameters) {
    const Parameter& parameter = system.problem().parameters()[p];
    Estimate e{p, fit.values[p], 0, fit.values[p], fit.values[p], true};
    const auto found = std::find(u.parameters.begin(), u.parameters.end(), p);
    if (found != u.parameters.end()) {
      const auto c = found - u.parameters.begin();
      e.at_bound = false;
      e.sigma = std::sqrt(std::max(0.0, u.covariance(c, c)));
      const double width = e.sigma * stats::student_quantile(0.975, u.degrees[static_cast<std::size_t>(c)]);
      e.lower_95 = std::max(parameter.lower, e.value - width);
      e.upper_95 = std::min(parameter.upper, e.value + width);
    }
    result.push_back(e);
  }
  return result;
}

double neutral_p(const System& system, const Fit& fit, const Uncertainty& u,
                 const std::vector<std::size_t>& parameters) {
  std::vector<Eigen::Index> places;
  std::vector<double> distance;
  for (const std::size_t p : parameters) {
    const auto found = std::find(u.parameters.begin(), u.parameters.end(), p);
    if (found == u.parameters.end()) continue;
    places.push_back(found - u.parameters.begin());
    distance.push_back(fit.values[p] - system.problem().parameters()[p].neutral);
  }
  if (places.empty()) return 1;
  const Eigen::MatrixXd c = u.covariance(places, places);
  const Eigen::VectorXd scale = c.diagonal().unaryExpr([](double d) { return d > 0 ? 1 / std::sqrt(d) : 0.0; });
  const Eigen::Map<const Eigen::VectorXd> d(distance.data(), static_cast<Eigen::Index>(distance.size()));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scale.asDiagonal() * c * scale.asDiagonal());
  const Eigen::VectorXd z = eigen.eigenvectors().transpose() * (scale.asDiagonal() * d);
  double statistic = 0, rank = 0;
  for (Eigen::Index k = 0; k < z.size(); ++k) {
    if (eigen.eigenvalues()[k] < 1e-9) continue;
    statistic += z[k] * z[k] / eigen.eigenvalues()[k];
    rank += 1;
  }
  return rank > 0 ? stats::chi2_upper(statistic, rank) : 1;
}

}  // namespace gonio::explain
