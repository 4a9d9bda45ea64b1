// See limits.h.
#include "goniometry/fit/limits.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "linear/qr.h"
#include "surface/microfacet.h"

namespace gonio::goniometry {
namespace {

constexpr double azimuth_counts_from = 0.05;  // rad: nearer to the normal the azimuth of a half vector says little
constexpr std::size_t hats_over_slope = 10, hats_over_opening = 6;

// Piecewise linear functions over quantiles of the values, one column each.
Eigen::MatrixXd hats(const std::vector<double>& values, std::size_t count) {
  std::vector<double> sorted = values, knots;
  std::ranges::sort(sorted);
  for (std::size_t k = 0; k < count; ++k) {
    const double knot = sorted[k * (sorted.size() - 1) / (count - 1)];
    if (knots.empty() || knot > knots.back() + 1e-6) knots.push_back(knot);
  }
  Eigen::MatrixXd all =
      Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(values.size()), static_cast<Eigen::Index>(knots.size()));
  for (std::size_t i = 0; i < values.size(); ++i) {
    const double value = std::clamp(values[i], knots.front(), knots.back());
    const auto above = static_cast<std::size_t>(std::ranges::lower_bound(knots, value) - knots.begin());
    const auto row = static_cast<Eigen::Index>(i), to = static_cast<Eigen::Index>(above);
    if (above == 0) {
      all(row, 0) = 1;
      continue;
    }
    const double share = (value - knots[above - 1]) / (knots[above] - knots[above - 1]);
    all(row, to) = share, all(row, to - 1) = 1 - share;
  }
  return all;
}

}  // namespace

double least_alpha(const Samples& samples) {
  std::vector<double> slopes;
  for (std::size_t r = 0; r < samples.rows(); ++r) {
    const Vec3 h = surface::half_vector(samples.wo[r], samples.wi[r]);
    if (h.z > 0) slopes.push_back(std::hypot(h.x, h.y) / h.z);
  }
  std::ranges::sort(slopes);
  const auto any_between = [&](double above, double up_to) {
    const auto found = std::ranges::upper_bound(slopes, above);
    return found != slopes.end() && *found <= up_to;
  };
  double least = 1;
  for (double alpha = 1; alpha > 1e-5; alpha /= 1.02) {
    if (slopes.empty() || slopes.front() > alpha / 2 || !any_between(alpha / 2, 1.5 * alpha)) break;
    least = alpha;
  }
  return least;
}

std::string too_narrow(double least) {
  char text[200];
  std::snprintf(text, sizeof text,
                "alpha < %.2g cannot be told from these angles: no two half vectors lie close enough to the peak; take "
                "directions around the mirror direction in smaller steps",
                least);
  return text;
}

double told_direction(const Samples& samples) {
  std::vector<double> leans, opens, azimuth, weight;
  for (std::size_t r = 0; r < samples.rows(); ++r) {
    const Vec3 h = surface::half_vector(samples.wo[r], samples.wi[r]);
    leans.push_back(std::atan2(std::hypot(h.x, h.y), h.z));
    opens.push_back(std::acos(std::clamp(dot(h, samples.wi[r]), -1.0, 1.0)));
    azimuth.push_back(std::atan2(h.y, h.x));
    weight.push_back(std::min(1.0, leans.back() / azimuth_counts_from));
  }
  const Eigen::MatrixXd over = hats(leans, hats_over_slope), under = hats(opens, hats_over_opening);
  const auto n = static_cast<Eigen::Index>(samples.rows());
  Eigen::MatrixXd smooth(n, over.cols() * under.cols()), turns(n, 2);
  double norm = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const auto r = static_cast<std::size_t>(i);
    for (Eigen::Index k = 0; k < over.cols(); ++k)
      smooth.row(i).segment(k * under.cols(), under.cols()) = weight[r] * over(i, k) * under.row(i);
    turns.row(i) << weight[r] * std::cos(2 * azimuth[r]), weight[r] * std::sin(2 * azimuth[r]);
    norm += 0.5 * weight[r] * weight[r];
  }
  if (!(norm > 0)) return 0;
  const linear::PivotedQr qr(smooth, 1e-8);
  const Eigen::MatrixXd rotated = qr.turned(turns);
  const Eigen::MatrixXd left = rotated.bottomRows(n - qr.rank());
  if (left.rows() == 0) return 0;
  norm *= static_cast<double>(left.rows()) / static_cast<double>(n);  // what chance would leave of many functions
  const Eigen::Matrix2d square = left.transpose() * left / norm;
  const double mean = square.trace() / 2, apart = std::hypot((square(0, 0) - square(1, 1)) / 2, square(0, 1));
  return std::sqrt(std::max(0.0, mean - apart));
}

bool turns_about_normal(const Samples& samples) {
  return told_direction(samples) >= least_told_direction;
}

}  // namespace gonio::goniometry
