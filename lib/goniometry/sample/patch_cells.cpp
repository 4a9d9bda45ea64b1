// Smooth courses over a patch and what leaves them (goniometry/sample/patch_cells.h).
#include "goniometry/sample/patch_cells.h"

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/random.h"
#include "linear/qr.h"
#include "stats/intervals.h"

namespace gonio::goniometry {
namespace {

constexpr double outlying_sigmas = 6, least_deviation = 0.05, mad_to_sigma = 1.4826,
                 median_widening = 1.2533;  // of many normal numbers: standard deviation over that of their mean
constexpr int trials = 200, refinements = 4;

int terms_for(std::size_t cells) {
  return cells >= 24 ? 6 : cells >= 9 ? 3 : 1;
}

Eigen::VectorXd basis(Vec2 at, int terms) {
  const std::array<double, 6> all = {1, at.x, at.y, at.x * at.x, at.x * at.y, at.y * at.y};
  return Eigen::Map<const Eigen::VectorXd>(all.data(), terms);
}

Eigen::MatrixXd design(const std::vector<PatchCell>& cells, int terms) {
  Eigen::MatrixXd a(static_cast<Eigen::Index>(cells.size()), terms);
  for (std::size_t i = 0; i < cells.size(); ++i)
    a.row(static_cast<Eigen::Index>(i)) = basis(cells[i].at, terms).transpose();
  return a;
}

std::vector<double> sizes_of(const Eigen::VectorXd& residuals) {
  std::vector<double> sizes(static_cast<std::size_t>(residuals.size()));
  for (std::size_t i = 0; i < sizes.size(); ++i) sizes[i] = std::abs(residuals[static_cast<Eigen::Index>(i)]);
  return sizes;
}

// Coefficients whose median absolute residual is least over polynomials through `terms` random cells.
Eigen::VectorXd least_median(const Eigen::MatrixXd& a, const Eigen::VectorXd& y) {
  const auto terms = a.cols(), count = a.rows();
  Random random(1, static_cast<std::uint64_t>(count));
  Eigen::VectorXd best = Eigen::VectorXd::Zero(terms);
  best[0] = stats::median({y.data(), static_cast<std::size_t>(count)});
  double least = stats::median(sizes_of(y - a * best));
  std::vector<Eigen::Index> order(static_cast<std::size_t>(count));
  std::iota(order.begin(), order.end(), 0);
  for (int trial = 0; trial < trials; ++trial) {
    Eigen::MatrixXd through(terms, terms);
    Eigen::VectorXd values(terms);
    for (Eigen::Index k = 0; k < terms; ++k) {  // the first of a shuffle
      const auto other = k + static_cast<Eigen::Index>(random.below(static_cast<std::uint32_t>(count - k)));
      std::swap(order[static_cast<std::size_t>(k)], order[static_cast<std::size_t>(other)]);
      through.row(k) = a.row(order[static_cast<std::size_t>(k)]);
      values[k] = y[order[static_cast<std::size_t>(k)]];
    }
    const Eigen::VectorXd x = through.fullPivLu().solve(values);
    if (!x.allFinite()) continue;
    const double median = stats::median(sizes_of(y - a * x));
    if (median < least) least = median, best = x;
  }
  return best;
}

// Least squares over the cells near the course, again and again.
Eigen::VectorXd refined(const Eigen::MatrixXd& a, const Eigen::VectorXd& y, Eigen::VectorXd x, double floor) {
  for (int step = 0; step < refinements; ++step) {
    const Eigen::VectorXd r = y - a * x;
    const double limit = 2.5 * std::max(floor, mad_to_sigma * stats::median(sizes_of(r)));
    Eigen::VectorXd near(a.rows());
    for (Eigen::Index i = 0; i < a.rows(); ++i) near[i] = std::abs(r[i]) <= limit ? 1 : 0;
    if (near.sum() < 2.0 * static_cast<double>(a.cols())) break;
    x = linear::PivotedQr(near.asDiagonal() * a).solve(near.cwiseProduct(y));
  }
  return x;
}

// How far each cell leaves the course of the majority, relative to the course; 0 where it does not.
std::vector<double> deviations(const Eigen::MatrixXd& a, const Eigen::VectorXd& y, const std::vector<double>& noise) {
  const double floor = std::max(stats::median(noise), 1e-6 * stats::median(sizes_of(y)));
  const Eigen::VectorXd course = a * refined(a, y, least_median(a, y), floor);
  const Eigen::VectorXd r = y - course;
  const double spread = std::max(floor, mad_to_sigma * stats::median(sizes_of(r)));
  const double least = least_deviation * stats::median(sizes_of(course));
  std::vector<double> result(noise.size());
  for (std::size_t i = 0; i < noise.size(); ++i) {
    const double off = r[static_cast<Eigen::Index>(i)];
    if (std::abs(off) >= outlying_sigmas * std::max(spread, noise[i]) && std::abs(off) >= least)
      result[i] = off / course[static_cast<Eigen::Index>(i)];
  }
  return result;
}

}  // namespace

Scatter scatter_of(const std::vector<PatchCell>& cells) {
  const int terms = terms_for(cells.size()), degrees = static_cast<int>(cells.size()) - terms;
  if (degrees < 3) return {};
  // Cells that the patch's edge cuts count for less.
  Eigen::VectorXd root(static_cast<Eigen::Index>(cells.size()));
  for (std::size_t i = 0; i < cells.size(); ++i) root[static_cast<Eigen::Index>(i)] = std::sqrt(mean(cells[i].weight));
  const Eigen::MatrixXd a = root.asDiagonal() * design(cells, terms);
  const auto solver = linear::PivotedQr(a);
  std::array<double, 3> variance{};
  for (int band = 0; band < 3; ++band) {
    Eigen::VectorXd y(root.size());
    for (std::size_t i = 0; i < cells.size(); ++i)
      y[static_cast<Eigen::Index>(i)] = root[static_cast<Eigen::Index>(i)] * cells[i].ratio[band];
    // Weighted residuals have the variance of a ratio at weight one; the weighted mean has it over the sum of weights.
    variance[static_cast<std::size_t>(band)] = (y - a * solver.solve(y)).squaredNorm() / degrees / root.squaredNorm();
  }
  return {{variance[0], variance[1], variance[2]}, degrees};
}

Outlying outlying_cells(const std::vector<PatchCell>& cells) {
  if (cells.size() < 9) return {};
  const Eigen::MatrixXd a = design(cells, terms_for(cells.size()));
  Eigen::VectorXd means(a.rows()), middles(a.rows());
  std::vector<double> noise, wider;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    means[static_cast<Eigen::Index>(i)] = mean(cells[i].ratio);
    middles[static_cast<Eigen::Index>(i)] = cells[i].middle;
    const Rgb v = cells[i].variance;
    noise.push_back(std::isnan(v.x) ? 0 : std::sqrt(v.x + v.y + v.z) / 3);
    wider.push_back(median_widening * noise.back());
  }
  const std::vector<double> by_mean = deviations(a, means, noise), by_middle = deviations(a, middles, wider);
  Outlying result;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (!(by_mean[i] * by_middle[i] > 0)) continue;
    ++result.count;
    if (std::abs(by_mean[i]) > std::abs(result.farthest)) result.farthest = by_mean[i];
  }
  return result;
}

}  // namespace gonio::goniometry
