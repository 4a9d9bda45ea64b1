// See uncertainty.h.
#include "goniometry/fit/uncertainty.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/parallel.h"
#include "linear/symmetric_eigen.h"
#include "stats/distributions.h"

namespace gonio::goniometry {
namespace {

constexpr std::size_t wanted_blocks = 20;
constexpr double least_left = 0.1;  // of a block's residual that the fit leaves it, for the correction
constexpr double blind = 1e-10;     // eigenvalue, of unit columns, below which a direction was not seen

// Rows of one series in the order of wo along the longest axis of their spread.
void sort_along(const Samples& s, Rows& rows) {
  double mx = 0, my = 0, xx = 0, xy = 0, yy = 0;
  for (const std::uint32_t r : rows) mx += s.wo[r].x, my += s.wo[r].y;
  mx /= static_cast<double>(rows.size()), my /= static_cast<double>(rows.size());
  for (const std::uint32_t r : rows) {
    const double x = s.wo[r].x - mx, y = s.wo[r].y - my;
    xx += x * x, xy += x * y, yy += y * y;
  }
  const double axis = 0.5 * std::atan2(2 * xy, xx - yy), cx = std::cos(axis), cy = std::sin(axis);
  std::ranges::stable_sort(rows, {}, [&](std::uint32_t r) { return cx * s.wo[r].x + cy * s.wo[r].y; });
}

std::vector<std::size_t> free_numbers(const Candidate& candidate, const Solution& solution) {
  std::vector<std::size_t> free;
  for (std::size_t i = 0; i < solution.x.size(); ++i) {
    const Slot& slot = slot_of(candidate, i);
    const double margin = 1e-9 * (slot.upper - slot.lower);
    if (slot.periodic || (solution.x[i] > slot.lower + margin && solution.x[i] < slot.upper - margin))
      free.push_back(i);
  }
  return free;
}

struct Inverse {
  Eigen::MatrixXd of, root;  // root root' = of
  std::vector<bool> seen;    // per column
};
Inverse inverse_of(const Eigen::MatrixXd& h) {
  if (h.rows() == 0) return {h, h, {}};  // every number is at a bound
  const Eigen::VectorXd scale = h.diagonal().array().max(1e-300).rsqrt().matrix();
  const linear::SymmetricEigen<Eigen::MatrixXd> eigen(scale.asDiagonal() * h * scale.asDiagonal());
  Eigen::VectorXd root = Eigen::VectorXd::Zero(h.rows());
  Inverse inverse{{}, {}, std::vector<bool>(static_cast<std::size_t>(h.rows()), true)};
  for (Eigen::Index k = 0; k < h.rows(); ++k) {
    if (eigen.eigenvalues()[k] > blind) {
      root[k] = 1 / std::sqrt(eigen.eigenvalues()[k]);
      continue;
    }
    for (Eigen::Index i = 0; i < h.rows(); ++i)
      if (std::abs(eigen.eigenvectors()(i, k)) > 1e-3) inverse.seen[static_cast<std::size_t>(i)] = false;
  }
  for (Eigen::Index i = 0; i < h.rows(); ++i)
    if (!(h(i, i) > 0)) inverse.seen[static_cast<std::size_t>(i)] = false;
  inverse.root = scale.asDiagonal() * eigen.eigenvectors() * root.asDiagonal();
  inverse.of = inverse.root * inverse.root.transpose();
  return inverse;
}

// A block's score freed of its own pull: g + K L V ((1 - d)^-1/2 - 1) / d V' L' g, with K = J'J of the block, L the
// root of the inverse, and L' K L = V d V'.
Eigen::VectorXd corrected(const Eigen::MatrixXd& k, const Eigen::VectorXd& g, const Eigen::MatrixXd& root) {
  const linear::SymmetricEigen<Eigen::MatrixXd> eigen(root.transpose() * k * root);
  Eigen::VectorXd factor = (1 - eigen.eigenvalues().array()).max(least_left).rsqrt() - 1;
  for (Eigen::Index i = 0; i < factor.size(); ++i)
    factor[i] = eigen.eigenvalues()[i] > 1e-12 ? factor[i] / eigen.eigenvalues()[i] : 0.5;
  const Eigen::VectorXd pulled = eigen.eigenvectors().transpose() * (root.transpose() * g);
  return g + k * (root * (eigen.eigenvectors() * factor.cwiseProduct(pulled)));
}

struct ByBlocks {
  Eigen::MatrixXd covariance;
  Eigen::VectorXd degrees;
};
ByBlocks by_blocks(const Problem& problem, const Candidate& candidate, const Solution& solution,
                   const std::vector<Rows>& blocks, const std::vector<Eigen::Index>& free, const Inverse& inverse) {
  const auto n = static_cast<Eigen::Index>(free.size());
  if (n == 0) return {};
  Eigen::MatrixXd meat = Eigen::MatrixXd::Zero(n, n);
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(n), squares = sum;
  for (const Rows& rows : blocks) {
    const Normal own = problem.normal(candidate, solution.x, rows);
    const Eigen::MatrixXd k = own.h(free, free);
    const Eigen::VectorXd u = corrected(k, own.downhill(free), inverse.root);
    meat += u * u.transpose();
    const Eigen::VectorXd brings = (inverse.of * k * inverse.of).diagonal();
    sum += brings;
    squares += brings.cwiseAbs2();
  }
  return {inverse.of * meat * inverse.of, sum.cwiseAbs2().cwiseQuotient(squares.cwiseMax(1e-300)).cwiseMax(1.0)};
}

// At a bound: from it to where the cost is 3.84 s^2 higher, the others following: 2 pull d + curvature d^2 = 3.84 s^2.
void state_one_sided(const Normal& at, const std::vector<Eigen::Index>& free, const Inverse& inverse, Eigen::Index i,
                     double s2, const Slot& slot, FittedNumber& number) {
  const Eigen::VectorXd across = at.h.col(i)(free);
  const double curvature = std::max(0.0, at.h(i, i) - across.dot(inverse.of * across)), pull = std::abs(at.downhill[i]),
               most = 3.84 * s2;
  const double root = std::sqrt(pull * pull + curvature * most), far = pull + root > 0 ? most / (pull + root) : 1e300;
  const bool low = number.value < (slot.lower + slot.upper) / 2;
  number.at = low ? FittedNumber::At::lower : FittedNumber::At::upper;
  number.sigma = std::numeric_limits<double>::quiet_NaN();
  number.low = low ? slot.lower : std::max(slot.lower, slot.upper - far);
  number.high = low ? std::min(slot.upper, slot.lower + far) : slot.upper;
}

void state_interval(const Slot& slot, FittedNumber& n) {
  const double reach = std::isfinite(n.sigma) ? stats::student_quantile(0.975, n.degrees) * n.sigma
                                              : std::numeric_limits<double>::infinity();
  n.low = n.value - reach, n.high = n.value + reach;
  if (!slot.periodic) n.low = std::max(n.low, slot.lower), n.high = std::min(n.high, slot.upper);
}

}  // namespace

std::vector<Rows> blocks_of(const Problem& problem) {
  const Samples& s = problem.samples();
  std::map<std::size_t, Rows> series;
  for (const std::uint32_t r : problem.rows()) series[s.series.empty() ? 0 : s.series[r]].push_back(r);
  const std::size_t pieces = series.size() >= wanted_blocks ? 1 : (wanted_blocks - 1) / series.size() + 1;
  std::vector<Rows> blocks;
  for (auto& [id, rows] : series) {
    sort_along(s, rows);
    const std::size_t count = std::min(pieces, rows.size());
    for (std::size_t k = 0; k < count; ++k) {
      const auto at = [&](std::size_t j) {
        return rows.begin() + static_cast<std::ptrdiff_t>(j * rows.size() / count);
      };
      blocks.emplace_back(at(k), at(k + 1));
    }
  }
  return blocks;
}

void state_uncertainty(const Problem& problem, const Candidate& candidate, const Solution& solution,
                       const std::vector<Rows>& blocks, Fit& fit) {
  const std::vector<std::size_t> inner = free_numbers(candidate, solution);
  const std::vector<Eigen::Index> free(inner.begin(), inner.end());
  const Normal& at = solution.at;
  const Inverse inverse = inverse_of(at.h(free, free));
  const double left = static_cast<double>(at.observations) - static_cast<double>(inner.size());
  const double mean_square = left > 0 ? at.cost / left : std::numeric_limits<double>::infinity();
  const double s2 = problem.scale() == Scale::noise ? std::max(1.0, mean_square) : mean_square;
  const ByBlocks robust = by_blocks(problem, candidate, solution, blocks, free, inverse);
  const std::size_t all = solution.x.size(), s = candidate.shared.size(), c = candidate.colours.size();
  Eigen::VectorXd stretch = Eigen::VectorXd::Ones(static_cast<Eigen::Index>(inner.size()));
  fit.numbers.clear();
  for (std::size_t i = 0; i < all; ++i)
    fit.numbers.push_back({.name = candidate.name(slot_of(candidate, i)),
                           .band = i < s ? whole_sample : (i - s) / c,
                           .value = solution.x[i]});
  for (std::size_t k = 0; k < inner.size(); ++k) {
    FittedNumber& number = fit.numbers[inner[k]];
    const auto j = static_cast<Eigen::Index>(k);
    const double plain = s2 * inverse.of(j, j), degrees = robust.degrees[j];
    double variance = plain;
    number.degrees = std::max(1.0, left);
    if (robust.covariance(j, j) > plain * stats::chi2_quantile(0.95, degrees) / degrees)
      variance = robust.covariance(j, j), number.degrees = degrees;
    stretch[j] = plain > 0 ? std::sqrt(variance / plain) : 1;
    number.sigma = inverse.seen[k] ? std::sqrt(variance) : std::numeric_limits<double>::quiet_NaN();
    state_interval(slot_of(candidate, inner[k]), number);
  }
  fit.covariance.assign(all * all, 0);
  for (std::size_t k = 0; k < inner.size(); ++k)
    for (std::size_t l = 0; l < inner.size(); ++l) {
      const auto a = static_cast<Eigen::Index>(k), b = static_cast<Eigen::Index>(l);
      fit.covariance[inner[k] * all + inner[l]] = s2 * inverse.of(a, b) * stretch[a] * stretch[b];
    }
  for (std::size_t i = 0; i < all; ++i)
    if (std::ranges::find(inner, i) == inner.end())
      state_one_sided(at, free, inverse, static_cast<Eigen::Index>(i), s2, slot_of(candidate, i), fit.numbers[i]);
}

}  // namespace gonio::goniometry
