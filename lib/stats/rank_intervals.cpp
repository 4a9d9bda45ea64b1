// Ranks of a factor's levels. Means are linear in y: mean_i = l_i'y, and a draw of the wild bootstrap moves it by
//   sum over blocks of v_b c_ib,   c_ib = l_ib' e_b,   v_b = -1 or 1,
// e_b the residuals of block b against a fit without it, (1 - Q_b Q_b')^-1 residual_b (CR3), times sqrt((G - 1) / G) of
// G blocks. Nothing is refitted. Few blocks: critical values grow by Student's over the normal quantile, G - 1 degrees.
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "base/error.h"
#include "base/random.h"
#include "base/text.h"
#include "linear/symmetric_eigen.h"
#include "stats/anova_projections.h"
#include "stats/distributions.h"
#include "stats/intervals.h"
#include "stats/model_columns.h"

namespace gonio::stats {
namespace {

using Eigen::Index;

struct Levels {
  Eigen::VectorXd mean;   // less the mean of all levels
  Eigen::MatrixXd moves;  // c: levels x blocks
};

std::vector<std::vector<Index>> members(std::span<const int> blocks, std::size_t n) {
  std::map<int, std::vector<Index>> by_block;
  for (std::size_t i = 0; i < n; ++i)
    by_block[blocks.empty() ? static_cast<int>(i) : blocks[i]].push_back(static_cast<Index>(i));
  std::vector<std::vector<Index>> list;
  for (auto& [name, rows] : by_block) list.push_back(std::move(rows));
  return list;
}

// Residuals of these observations against a fit that leaves them out; where that fit cannot tell them, what it can.
Eigen::VectorXd left_out(const Anova& fit, const std::vector<Index>& rows) {
  const Eigen::MatrixXd q = fit.projections->q(rows, Eigen::all);
  Eigen::VectorXd e(q.rows());
  for (Index i = 0; i < e.size(); ++i)
    e(i) = fit.residuals[static_cast<std::size_t>(rows[static_cast<std::size_t>(i)])];
  const linear::SymmetricEigen<Eigen::MatrixXd> solver(Eigen::MatrixXd::Identity(q.rows(), q.rows()) -
                                                              q * q.transpose());
  Eigen::VectorXd turned = solver.eigenvectors().transpose() * e;
  for (Index i = 0; i < turned.size(); ++i)
    turned(i) *= solver.eigenvalues()(i) > 1e-9 ? 1 / solver.eigenvalues()(i) : 0;
  return solver.eigenvectors() * turned;
}

Levels levels_of(const Design& design, const Anova& fit, int factor, const std::vector<std::vector<Index>>& blocks) {
  const Factor& f = design.factors[static_cast<std::size_t>(factor)];
  const auto k = static_cast<Index>(f.levels.size());
  Eigen::MatrixXd weight(fit.projections->q.rows(), k);
  Levels result{Eigen::VectorXd(k), Eigen::MatrixXd(k, static_cast<Index>(blocks.size()))};
  for (int l = 0; l < k; ++l) {
    const Eigen::VectorXd lambda =
        estimable(*fit.projections, contrast_at(design, *fit.projections, {factor}, std::vector<int>{l}, true));
    if (lambda.size() == 0)
      throw Error(Exit::data, f.name,
                  "\"" + f.levels[static_cast<std::size_t>(l)] + "\" cannot be compared with the others",
                  "leave out the interactions whose cells are empty");
    result.mean(l) = lambda.dot(fit.projections->z);
    weight.col(l) = fit.projections->q * lambda;
  }
  const double g = static_cast<double>(blocks.size());
  for (std::size_t b = 0; b < blocks.size(); ++b)
    result.moves.col(static_cast<Index>(b)) =
        weight(blocks[b], Eigen::all).transpose() * left_out(fit, blocks[b]) * std::sqrt((g - 1) / g);
  return result;
}

// Ascending; equal means share the mean of their ranks.
double rank_of(const Eigen::VectorXd& mean, Index level) {
  const double below = static_cast<double>((mean.array() < mean(level)).count());
  const double same = static_cast<double>((mean.array() == mean(level)).count());
  return below + (same + 1) / 2;
}

// Of each level, the largest standardised move of its differences, by draw; and who was first.
struct Draws {
  std::vector<std::vector<double>> largest;  // [level][draw]
  std::vector<int> first;
};
Draws draw(const Levels& levels, const Eigen::MatrixXd& sigma, int draws, unsigned long long seed) {
  const Index k = levels.mean.size(), g = levels.moves.cols();
  Draws result{std::vector<std::vector<double>>(static_cast<std::size_t>(k)),
               std::vector<int>(static_cast<std::size_t>(k))};
  Random random(seed);
  Eigen::VectorXd sign(g);
  for (int n = 0; n < draws; ++n) {
    for (Index b = 0; b < g; ++b) sign(b) = random.next() & 0x80000000u ? 1 : -1;
    const Eigen::VectorXd move = levels.moves * sign;
    Index best = 0;
    (levels.mean + move).minCoeff(&best);
    ++result.first[static_cast<std::size_t>(best)];
    for (Index i = 0; i < k; ++i) {
      double most = 0;
      for (Index j = 0; j < k; ++j)
        if (sigma(i, j) > 0) most = std::max(most, std::abs(move(i) - move(j)) / sigma(i, j));
      result.largest[static_cast<std::size_t>(i)].push_back(most);
    }
  }
  return result;
}

}  // namespace

std::vector<Rank> bootstrap_ranks(const Design& design, const std::vector<Term>& terms, int factor,
                                  std::span<const int> blocks, int draws, double confidence, unsigned long long seed) {
  const auto groups = members(blocks, design.y.size());
  if (groups.size() < 3)
    throw Error(Exit::data, "results", format("%zu blocks of results, ranks need at least 3", groups.size()),
                "name the sequences that results belong to");
  const Anova fit = anova(design, terms, SumsOfSquares::type1);
  const Levels levels = levels_of(design, fit, factor, groups);
  const Index k = levels.mean.size();
  Eigen::MatrixXd sigma(k, k);
  for (Index i = 0; i < k; ++i)
    for (Index j = 0; j < k; ++j) sigma(i, j) = (levels.moves.row(i) - levels.moves.row(j)).norm();
  const Draws drawn = draw(levels, sigma, draws, seed);
  const double two_sided = 0.5 + confidence / 2;
  const double few = student_quantile(two_sided, static_cast<double>(groups.size()) - 1) / normal_quantile(two_sided);
  const std::vector<MarginalMean> means = marginal_means(fit, design, {factor});
  std::vector<Rank> ranks;
  for (Index i = 0; i < k; ++i) {
    const auto l = static_cast<std::size_t>(i);
    const double critical = few * quantile(drawn.largest[l], confidence);
    Rank rank{static_cast<int>(i),     means[l].value,
              rank_of(levels.mean, i), 1,
              static_cast<double>(k),  static_cast<double>(drawn.first[l]) / std::max(1, draws)};
    for (Index j = 0; j < k; ++j) {
      if (j == i) continue;
      const double difference = levels.mean(i) - levels.mean(j);
      rank.lower += difference > critical * sigma(i, j);
      rank.upper -= difference < -critical * sigma(i, j);
    }
    ranks.push_back(rank);
  }
  std::stable_sort(ranks.begin(), ranks.end(), [](const Rank& a, const Rank& b) { return a.rank < b.rank; });
  return ranks;
}

}  // namespace gonio::stats
