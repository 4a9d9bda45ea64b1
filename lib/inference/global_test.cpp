// See global_test.h. Every look becomes a matrix W (blocks x directions) and degrees d such that |1'W|^2 ~
// chi-square(d) under the null: fixed numbers W = U V^-1/2 with V = U'U and d its rank; draws of one law W = U sqrt(tr
// V / tr V^2), d = (tr V)^2 / tr V^2.
#include "inference/global_test.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "linear/blocks.h"
#include "stats/distributions.h"

namespace gonio::inference {
namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
constexpr double least_share = 1e-6;  // of a direction's length that others leave it

struct Standardised {
  Eigen::MatrixXd w;
  double degrees = 0;
  double p(const Eigen::RowVectorXd& sum, double inflation) const {
    return degrees > 0 ? stats::chi2_upper(sum.squaredNorm() / inflation, degrees) : 1.0;
  }
};

Standardised standardised(const Look& look, std::size_t blocks) {
  const auto rows = static_cast<Eigen::Index>(blocks), columns = static_cast<Eigen::Index>(look.scores.directions);
  Standardised result{Eigen::MatrixXd(rows, 0), 0};
  if (columns == 0) return result;
  const Eigen::Map<const RowMatrix> u(look.scores.contributions.data(), rows, columns);
  if (look.of_single_groups) {
    const Eigen::MatrixXd v = u.transpose() * u;
    const double trace = v.trace(), squares = v.squaredNorm();
    if (!(squares > 0)) return result;
    return {u * std::sqrt(trace / squares), trace * trace / squares};
  }
  const Eigen::VectorXd scale =
      u.colwise().norm().transpose().unaryExpr([](double length) { return length > 0 ? 1 / length : 0.0; });
  const Eigen::MatrixXd v = u * scale.asDiagonal();
  const linear::EigenPairs eigen = linear::eigen_of(v.transpose() * v);
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < columns; ++k)
    if (eigen.values[k] > least_share) kept.push_back(k);
  const Eigen::VectorXd root = eigen.values(kept).cwiseSqrt().cwiseInverse();
  return {v * (eigen.vectors(Eigen::all, kept) * root.asDiagonal()), static_cast<double>(kept.size())};
}

}  // namespace

double global_p(const std::vector<Look>& looks, std::size_t blocks, double inflation, int draws, std::uint64_t seed) {
  std::vector<Standardised> all;
  double observed = 1;
  for (const Look& look : looks) {
    all.push_back(standardised(look, blocks));
    observed = std::min(observed, all.back().p(all.back().w.colwise().sum(), inflation));
  }
  std::vector<double> smallest(static_cast<std::size_t>(draws), 1.0);
  parallel_for(0, smallest.size(), [&](std::size_t draw) {
    Random random(seed, draw);
    Eigen::RowVectorXd sign(static_cast<Eigen::Index>(blocks));
    for (Eigen::Index b = 0; b < sign.size(); ++b) sign[b] = random.next() >> 31 ? 1.0 : -1.0;
    for (const Standardised& s : all) smallest[draw] = std::min(smallest[draw], s.p(sign * s.w, 1));
  });
  // The observed order counts as one of the draws, so that no p is ever zero.
  const auto below = std::count_if(smallest.begin(), smallest.end(), [&](double p) { return p <= observed; });
  return static_cast<double>(below + 1) / static_cast<double>(draws + 1);
}

}  // namespace gonio::inference
