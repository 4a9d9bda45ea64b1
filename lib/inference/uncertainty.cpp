// See fit.h: covariance, intervals and the test of "neutral".
#include <algorithm>
#include <cmath>
#include <map>

#include "base/parallel.h"
#include "inference/fit.h"
#include "inference/scaling.h"
#include "linear/blocks.h"
#include "linear/solve.h"
#include "stats/distributions.h"

namespace gonio::inference {
namespace {

constexpr double many = 1e6;  // degrees of freedom of a normal law

constexpr double least_left = 0.1;  // of a block's residual that the fit leaves it, for the correction

// Sum over blocks of u u', u the block's score J'(I - H)^-1/2 r with H = J C J' its share of the fit that it has pulled
// towards itself (CR2: Bell & McCaffrey, Survey Methodology 28, 2002); and for every parameter the effective number of
// blocks that it rests on, (sum a)^2 / sum a^2 with a the variance that each of them brings: Satterthwaite's degrees of
// freedom.
struct Meat {
  Eigen::MatrixXd scores;  // of one group: at `places` only
  std::vector<Eigen::Index> places;
  Eigen::VectorXd sum, squares;  // of a
};

constexpr Eigen::Index many_columns = 100;  // beyond: eigenvectors take too long

// L of C = L L': V sqrt(d) of C = V d V', or by Cholesky.
Eigen::MatrixXd root_of(const Eigen::MatrixXd& c) {
  const Eigen::VectorXd scale = c.diagonal().unaryExpr([](double d) { return d > 0 ? std::sqrt(d) : 0.0; });
  const Eigen::VectorXd inverse = scale.unaryExpr([](double d) { return d > 0 ? 1 / d : 0.0; });
  if (c.rows() > many_columns) {
    const linear::Ldlt factor(inverse.asDiagonal() * c * inverse.asDiagonal());
    return scale.asDiagonal() * factor.root();
  }
  const linear::EigenPairs eigen = linear::eigen_of(inverse.asDiagonal() * c * inverse.asDiagonal());
  return scale.asDiagonal() * eigen.vectors * eigen.values.cwiseMax(0.0).cwiseSqrt().asDiagonal();
}

// J'(I - H)^-1/2 r of one block, H = A A' with A = J L: in the block's rows or in the parameters, whichever are fewer.
Eigen::VectorXd corrected_score(const Eigen::MatrixXd& j, const Eigen::MatrixXd& l, const Eigen::VectorXd& r) {
  const Eigen::MatrixXd a = j * l;
  const auto root = [](const linear::EigenPairs& eigen) {
    return Eigen::VectorXd((1 - eigen.values.array()).max(least_left).rsqrt());
  };
  if (a.rows() <= a.cols()) {
    const linear::EigenPairs eigen = linear::eigen_of(a * a.transpose());
    return j.transpose() * (eigen.vectors * (root(eigen).asDiagonal() * (eigen.vectors.transpose() * r)));
  }
  // (I - A A')^-1/2 = I + A V ((1 - d)^-1/2 - 1) / d V' A' with A'A = V d V'.
  const linear::EigenPairs eigen = linear::eigen_of(a.transpose() * a);
  Eigen::VectorXd factor = root(eigen).array() - 1;
  for (Eigen::Index k = 0; k < factor.size(); ++k)
    factor[k] = eigen.values[k] > 1e-12 ? factor[k] / eigen.values[k] : 0.5;
  const Eigen::VectorXd pulled = eigen.vectors.transpose() * (a.transpose() * r);
  return j.transpose() * (r + a * (eigen.vectors * (factor.asDiagonal() * pulled)));
}

Meat meat_of_group(const System& system, const Fit& fit, const Eigen::MatrixXd& inverse, std::size_t group,
                   const Slopes* kept) {
  const Observations& o = system.observations();
  const auto n = static_cast<Eigen::Index>(fit.inner.size());
  std::vector<std::size_t> parameters;
  std::vector<Eigen::Index> places;
  for (std::size_t c = 0; c < fit.inner.size(); ++c) {
    if (!system.touches(fit.inner[c], group)) continue;
    parameters.push_back(fit.inner[c]);
    places.push_back(static_cast<Eigen::Index>(c));
  }
  const Eigen::MatrixXd j = system.jacobian(fit.values, group, parameters, kept);
  const Eigen::VectorXd r = system.residual(fit.values, group);
  const Eigen::MatrixXd root = root_of(inverse(places, places)), reach = inverse(Eigen::all, places);
  std::map<std::uint32_t, std::vector<Eigen::Index>> blocks;
  for (Eigen::Index i = 0; i < r.size(); ++i)
    blocks[o.block[o.first[group] + static_cast<std::size_t>(i)]].push_back(i);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(j.cols(), j.cols());
  Meat meat{{}, places, Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
  for (const auto& [block, rows] : blocks) {
    const Eigen::MatrixXd own = j(rows, Eigen::all);
    const Eigen::VectorXd u = corrected_score(own, root, r(rows));
    sum.noalias() += u * u.transpose();
    const Eigen::VectorXd brings = (reach * own.transpose()).rowwise().squaredNorm();
    meat.sum += brings;
    meat.squares += brings.cwiseAbs2();
  }
  meat.scores = std::move(sum);
  return meat;
}

Meat meat_of(const System& system, const Fit& fit, const Eigen::MatrixXd& inverse, const Slopes* kept) {
  std::vector<Meat> parts(system.groups.size());
  parallel_for(0, parts.size(),
               [&](std::size_t k) { parts[k] = meat_of_group(system, fit, inverse, system.groups[k], kept); });
  const auto n = static_cast<Eigen::Index>(fit.inner.size());
  Meat total{Eigen::MatrixXd::Zero(n, n), {}, Eigen::VectorXd::Zero(n), Eigen::VectorXd::Zero(n)};
  for (const Meat& part : parts) {
    total.scores(part.places, part.places) += part.scores;
    total.sum += part.sum;
    total.squares += part.squares;
  }
  return total;
}

// Variance of each parameter from leaving out one group at a time (one Gauss-Newton step each); zero where it is not
// shared.
Eigen::VectorXd jackknife(const System& system, const Linearisation& l, const std::vector<std::size_t>& columns) {
  const auto n = static_cast<Eigen::Index>(columns.size());
  const auto groups = static_cast<Eigen::Index>(l.grams.size());
  const LeaveOneOut others(l, columns);
  std::vector<Eigen::Index> places;  // of the shared columns, which stand in the same order
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (l.columns[columns[c]].local == LinearColumn::everywhere) places.push_back(static_cast<Eigen::Index>(c));
  Eigen::MatrixXd steps = Eigen::MatrixXd::Zero(n, groups);
  others.each([&](std::size_t g, const WithoutGroup& without) {
    steps.col(static_cast<Eigen::Index>(g))(places) = without.moved.col(0);
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
  Eigen::MatrixXd prior = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index c = 0; c < n; ++c) prior(c, c) = l.columns[static_cast<std::size_t>(c)].prior_precision;
  const Meat meat = meat_of(system, fit, inverse, kept);
  u.covariance = inverse * (meat.scores + prior) * inverse.transpose();
  u.by_blocks = u.covariance;
  for (Eigen::Index c = 0; c < n; ++c)
    if (meat.squares[c] > 0)
      u.degrees[static_cast<std::size_t>(c)] = std::max(1.0, meat.sum[c] * meat.sum[c] / meat.squares[c]);
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

double neutral_p(const System& system, const Fit& fit, const Uncertainty& u, const std::vector<std::size_t>& parameters,
                 bool by_blocks) {
  std::vector<Eigen::Index> places;
  std::vector<double> distance;
  for (const std::size_t p : parameters) {
    const auto found = std::find(u.parameters.begin(), u.parameters.end(), p);
    if (found == u.parameters.end()) continue;
    places.push_back(found - u.parameters.begin());
    distance.push_back(fit.values[p] - system.problem().parameters()[p].neutral);
  }
  if (places.empty()) return 1;
  const Eigen::MatrixXd c = (by_blocks ? u.by_blocks : u.covariance)(places, places);
  const Eigen::VectorXd scale = unit_scale(c.diagonal());
  const Eigen::Map<const Eigen::VectorXd> d(distance.data(), static_cast<Eigen::Index>(distance.size()));
  const linear::EigenPairs eigen = linear::eigen_of(scale.asDiagonal() * c * scale.asDiagonal());
  const Eigen::VectorXd z = eigen.vectors.transpose() * (scale.asDiagonal() * d);
  double statistic = 0, rank = 0;
  for (Eigen::Index k = 0; k < z.size(); ++k) {
    if (eigen.values[k] < 1e-9) continue;
    statistic += z[k] * z[k] / eigen.values[k];
    rank += 1;
  }
  return rank > 0 ? stats::chi2_upper(statistic, rank) : 1;
}

}  // namespace gonio::inference
