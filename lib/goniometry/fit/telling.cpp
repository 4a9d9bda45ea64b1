// See telling.h.
#include "goniometry/fit/telling.h"

#include <Eigen/Core>
#include <algorithm>
#include <cstdio>

#include "goniometry/fit/limits.h"
#include "linear/qr.h"

namespace gonio::goniometry {
namespace {

constexpr double least_share = 1e-3, rank = 1e-10;

bool of_variant(const std::string& name) {
  return name.starts_with("anisotropy") || name == "azimuth_rad" || name.starts_with("second_") ||
         name.starts_with("retro") || name == "sigma_rad";
}

double share_of(const Eigen::MatrixXd& slopes, Eigen::Index own) {
  const double length = slopes.col(own).norm();
  if (!(length > 0)) return 0;
  Eigen::MatrixXd others(slopes.rows(), slopes.cols() - 1);
  others << slopes.leftCols(own), slopes.rightCols(slopes.cols() - own - 1);
  for (Eigen::Index c = 0; c < others.cols(); ++c)
    if (const double other = others.col(c).norm(); other > 0) others.col(c) /= other;
  const linear::PivotedQr qr(others, rank);
  const Eigen::VectorXd turned = qr.turned(slopes.col(own) / length);
  return turned.tail(turned.size() - qr.rank()).norm();
}

}  // namespace

std::vector<Telling> telling(const Problem& problem, const Candidate& candidate,
                             const std::vector<std::vector<double>>& points) {
  std::vector<Telling> all;
  std::vector<Eigen::Index> column;
  for (std::size_t k = 0; k < candidate.shared.size(); ++k) {
    if (!of_variant(candidate.name(candidate.shared[k]))) continue;
    all.push_back({candidate.name(candidate.shared[k]), 0});
    column.push_back(static_cast<Eigen::Index>(k));
  }
  for (const std::vector<double>& x : points) {
    if (std::ranges::all_of(all, [](const Telling& t) { return t.share >= least_share; })) break;
    const Eigen::MatrixXd slopes = problem.slopes(candidate, x);
    for (std::size_t k = 0; k < all.size(); ++k) all[k].share = std::max(all[k].share, share_of(slopes, column[k]));
  }
  return all;
}

std::string untold_numbers(const std::vector<Telling>& telling) {
  std::string names;
  for (const Telling& t : telling)
    if (t.share < least_share) names += (names.empty() ? "" : ", ") + t.number;
  if (names.empty()) return {};
  return "these directions do not tell " + names +
         " from its other numbers: measure more angles, about the mirror direction, towards the light, near grazing";
}

std::string untold_direction(const Samples& samples) {
  char text[320];
  std::snprintf(text, sizeof text,
                "anisotropy and its axis, which these directions do not tell from the shape of the lobe (%.0f %% of "
                "their signature is left, %.0f %% is needed): turn the sample about its normal by 45 and 90 degrees "
                "and measure again",
                100 * told_direction(samples), 100 * least_told_direction);
  return text;
}

}  // namespace gonio::goniometry
