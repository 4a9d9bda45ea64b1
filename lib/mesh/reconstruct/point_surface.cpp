#include "mesh/reconstruct/point_surface.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "geom/covariance.h"
#include "linear/symmetric_eigen.h"
#include "mesh/clean/local_quadratic.h"
#include "stats/intervals.h"

namespace gonio::mesh {
namespace {

constexpr std::size_t plane_points = 24;
constexpr std::array<std::size_t, 9> windows{11, 16, 22, 30, 42, 58, 80, 112, 156};  // points of a fit
constexpr double agreement = 1.6;  // standard deviations within which windows agree
constexpr double surplus = 3;      // standard deviations by which chi-square may exceed its expectation
constexpr double seen_from = 0.1;  // least cosine between the normal and the way to a point's camera

// What a quadratic leaves, over what it should leave, and by how much that varies.
double reduced_chi_square(const LocalQuadratic::Fit& fit, double points) {
  return fit.residual / (points - 6);
}

struct Interval {
  double low = -1e300, high = 1e300;
  bool narrow(double value, double half) {  // is there still a value that all allow?
    low = std::max(low, value - half), high = std::min(high, value + half);
    return low <= high;
  }
};

// The widest window that agrees with all narrower ones.
struct Choice {
  std::array<Interval, 3> all{};
  LocalQuadratic::Fit fit{};
  double chi_square = 0;
  double drift = 0;  // mean square by which the height has moved since the window before, beyond what noise does
  bool found = false;
  bool take(const LocalQuadratic& sums) {  // may the window grow?
    const LocalQuadratic::Fit next = sums.fit();
    if (!next.good) return true;
    const double left = reduced_chi_square(next, sums.points());
    bool agrees = left <= 1 + surplus * std::sqrt(2 / (sums.points() - 6));
    agrees = all[0].narrow(next.c[0], agreement * std::sqrt(next.variance_of_height())) && agrees;
    for (int k = 0; k < 2; ++k)
      agrees = all[static_cast<std::size_t>(k + 1)].narrow(next.c[static_cast<std::size_t>(k + 1)],
                                                           agreement * std::sqrt(next.variance_of_slope(k))) &&
               agrees;
    if (found && !agrees) return false;
    const double moved = next.c[0] - fit.c[0];
    if (found) drift = std::max(0.0, moved * moved - (fit.variance_of_height() - next.variance_of_height()));
    fit = next, chi_square = left, found = true;
    return agrees;
  }
};

}  // namespace

Vec3 normal_of_plane(const PointTree& points, const std::vector<PointTree::Neighbour>& members) {
  Vec3 mean;
  for (const PointTree::Neighbour& m : members) mean += points[m.point];
  mean *= 1.0 / static_cast<double>(members.size());
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (const PointTree::Neighbour& m : members) {
    const Vec3 d = points[m.point] - mean;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j <= i; ++j) spread(i, j) += d[i] * d[j];
  }
  const linear::SymmetricEigen<Eigen::Matrix3d> axes(spread);
  const auto v = axes.eigenvectors().col(0);
  return normalized(Vec3{v(0), v(1), v(2)});
}

PointSurface::PointSurface(const MeasuredPoints& points, const PointTree& tree)
    : points_(points), tree_(tree), spacings_m_(points.positions_m.size()) {
  parallel_for(
      0, spacings_m_.size(),
      [&](std::size_t i) {
        std::vector<PointTree::Neighbour> near;
        tree_.nearest(points_.positions_m[i], 7, near);
        spacings_m_[i] = std::sqrt(near.back().squared);
      },
      1024);
  spacing_m_ = std::max(stats::median(spacings_m_), 1e-12);
  // Quadratics over few points hardly mistake shape for noise.
  const std::size_t probes = std::min<std::size_t>(2000, spacings_m_.size());
  std::vector<double> left(probes, -1);
  parallel_for(
      0, probes,
      [&](std::size_t k) {
        const auto point = static_cast<std::uint32_t>(k * spacings_m_.size() / probes);
        const Basis basis(plane_normal(point));
        std::vector<PointTree::Neighbour> near;
        tree_.nearest(points_.positions_m[point], plane_points, near);
        LocalQuadratic sums;
        for (const PointTree::Neighbour& m : near) {
          const Vec3 p = basis.to_local(points_.positions_m[m.point] - points_.positions_m[point]) / spacing_m_;
          sums.add(p.x, p.y, p.z, spacing_m_ * spacing_m_ / variance_m2(m.point, basis.n));
        }
        const LocalQuadratic::Fit fit = sums.fit();
        if (fit.good) left[k] = reduced_chi_square(fit, sums.points());
      },
      64);
  std::erase_if(left, [](double v) { return v < 0; });
  if (!left.empty()) noise_ratio_ = std::sqrt(std::max(1.0, stats::median(left)));
}

double PointSurface::variance_m2(std::uint32_t point, Vec3 direction) const {
  return variance_along(points_.covariance_m2[point], direction);
}

Vec3 PointSurface::towards_camera(std::uint32_t point) const {
  return normalized(points_.viewpoints_m[points_.view[point]][0] - points_.positions_m[point]);
}

Vec3 PointSurface::plane_normal(std::uint32_t point) const {
  std::vector<PointTree::Neighbour> near;
  tree_.nearest(points_.positions_m[point], plane_points, near);
  const Vec3 way = towards_camera(point);
  // Of a thin thing that was seen from both sides, one side.
  std::erase_if(near, [&](const PointTree::Neighbour& m) { return dot(towards_camera(m.point), way) < 0; });
  const Vec3 n = normal_of_plane(tree_, near);
  return dot(n, way) < 0 ? -n : n;
}

PointFit PointSurface::fit(Vec3 at, Vec3 normal) const {
  PointFit made{at, normal};
  const Basis basis(normal);
  std::vector<PointTree::Neighbour> near;
  tree_.nearest(at, windows.back(), near);
  LocalQuadratic sums;
  Choice choice;
  const double unit = spacing_m_, inflation = noise_ratio_ * noise_ratio_;
  double weights = 0;
  std::size_t window = 0;
  for (const PointTree::Neighbour& m : near) {
    if (dot(towards_camera(m.point), normal) < seen_from) continue;
    const Vec3 p = basis.to_local(points_.positions_m[m.point] - at) / unit;
    const double weight = unit * unit / (inflation * variance_m2(m.point, normal));
    sums.add(p.x, p.y, p.z, weight);
    weights += weight;
    if (sums.points() < static_cast<double>(windows[window])) continue;
    if (!choice.take(sums) || ++window == windows.size()) break;
  }
  if (!choice.found) return made;
  const LocalQuadratic::Fit& fit = choice.fit;
  made.good = true;
  made.point = at + normal * (fit.c[0] * unit);
  made.normal = normalized(basis.to_world({-fit.c[1], -fit.c[2], 1}));
  // Across a slope the height's error is longer than that along the normal.
  made.sigma_m = unit * std::sqrt(fit.variance_of_height() * std::max(1.0, choice.chi_square) + choice.drift) *
                 dot(made.normal, normal);
  made.point_sigma_m = unit * std::sqrt(sums.points() / weights);
  made.leverage = fit.variance_of_height() * weights / sums.points();
  return made;
}

}  // namespace gonio::mesh
