// See sign_flip.h. Contributions are whitened once, U -> U V^-1/2 with V = U'U, which signs do not change; a draw is
// then one signed column sum per direction.
#include "stats/sign_flip.h"

#include <Eigen/Core>
#include <algorithm>

#include "base/parallel.h"
#include "base/random.h"
#include "linear/symmetric_eigen.h"
#include "stats/distributions.h"

namespace gonio::stats {
namespace {

using RowMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::MatrixXd whitened(const ScoreFamily& family, std::size_t blocks) {
  if (family.directions == 0) return Eigen::MatrixXd(static_cast<Eigen::Index>(blocks), 0);
  const Eigen::Map<const RowMatrix> u(family.contributions.data(), static_cast<Eigen::Index>(blocks),
                                      static_cast<Eigen::Index>(family.directions));
  const Eigen::VectorXd length = u.colwise().norm().transpose();
  Eigen::VectorXd scale(length.size());
  for (Eigen::Index k = 0; k < length.size(); ++k) scale[k] = length[k] > 0 ? 1 / length[k] : 0;
  const Eigen::MatrixXd v = u * scale.asDiagonal();
  const linear::SymmetricEigen<Eigen::MatrixXd> eigen(v.transpose() * v);
  const Eigen::VectorXd& values = eigen.eigenvalues();
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < values.size(); ++k)
    if (values[k] > 1e-6) kept.push_back(k);
  Eigen::MatrixXd result(v.rows(), static_cast<Eigen::Index>(kept.size()));
  for (std::size_t k = 0; k < kept.size(); ++k)
    result.col(static_cast<Eigen::Index>(k)) = v * eigen.eigenvectors().col(kept[k]) / std::sqrt(values[kept[k]]);
  return result;
}

}  // namespace

SignFlipResult sign_flip_test(const std::vector<ScoreFamily>& families, std::size_t blocks, double inflation, int draws,
                              std::uint64_t seed) {
  SignFlipResult result;
  std::vector<Eigen::MatrixXd> white;
  for (const ScoreFamily& family : families) {
    white.push_back(whitened(family, blocks));
    const double statistic = white.back().colwise().sum().squaredNorm() / inflation;
    result.rank.push_back(static_cast<std::size_t>(white.back().cols()));
    result.statistic.push_back(statistic);
    result.p.push_back(result.rank.back() == 0 ? 1.0 : chi2_upper(statistic, static_cast<double>(result.rank.back())));
  }
  std::vector<double> smallest(static_cast<std::size_t>(draws), 1.0);
  parallel_for(0, smallest.size(), [&](std::size_t draw) {
    Random random(seed, draw);
    Eigen::RowVectorXd sign(static_cast<Eigen::Index>(blocks));
    for (Eigen::Index b = 0; b < sign.size(); ++b) sign[b] = random.next() >> 31 ? 1.0 : -1.0;
    for (const Eigen::MatrixXd& w : white)
      if (w.cols() > 0)
        smallest[draw] = std::min(smallest[draw], chi2_upper((sign * w).squaredNorm(), static_cast<double>(w.cols())));
  });
  std::sort(smallest.begin(), smallest.end());
  // The observed order counts as one of the draws, so no p is ever zero.
  const auto adjusted = [&](double p) {
    const auto below = std::upper_bound(smallest.begin(), smallest.end(), p) - smallest.begin();
    return static_cast<double>(below + 1) / static_cast<double>(draws + 1);
  };
  for (const double p : result.p) {
    result.adjusted_p.push_back(adjusted(p));
    result.global_p = std::min(result.global_p, result.adjusted_p.back());
  }
  return result;
}

}  // namespace gonio::stats
