#include "mesh/register/view_surface.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/parallel.h"
#include "base/random.h"
#include "geom/covariance.h"
#include "mesh/clean/local_quadratic.h"
#include "mesh/reconstruct/point_surface.h"
#include "stats/intervals.h"

namespace gonio::mesh {
namespace {

constexpr std::array<std::size_t, 4> fit_points{28, 56, 112, 224};
constexpr double usable_slope = 0.06;  // rad: normals of both sides then agree within their limit
constexpr double fold = 2.5;           // times the usual reduced chi-square
constexpr double beside = 0.4;         // centroid of a fit's points from its place, over their rms radius; 0.6 at a rim
constexpr std::size_t probe_count = 400;

// What a fit is made of, before it is judged.
struct LocalSums {
  std::vector<PointTree::Neighbour> near{};
  LocalQuadratic::Fit fit{};
  Vec3 normal{};
  double centroid = 0, radius_m = 0, chi_square = 0;
};

LocalSums sums_at(const PointTree& tree, const std::vector<std::array<double, 6>>& covariance, Vec3 camera, Vec3 at,
                  std::size_t window, double unit) {
  LocalSums made;
  std::vector<PointTree::Neighbour>& near = made.near;
  tree.nearest(at, window, near);
  made.normal = normal_of_plane(tree, near);
  // Far beside the surface the nearest points lean to where it is near; below the foot they do not.
  Vec3 middle;
  for (const PointTree::Neighbour& m : near) middle += tree[m.point] / static_cast<double>(near.size());
  const double off = dot(at - middle, made.normal);
  if (off * off > 0.1 * near.back().squared) {
    tree.nearest(at - made.normal * off, window, near);
    made.normal = normal_of_plane(tree, near);
  }
  if (dot(made.normal, camera - at) < 0) made.normal = -made.normal;
  const Basis basis(made.normal);
  LocalQuadratic sums;
  double u = 0, v = 0, squares = 0;
  for (const PointTree::Neighbour& m : near) {
    const Vec3 p = basis.to_local(tree[m.point] - at) / unit;
    sums.add(p.x, p.y, p.z, unit * unit / variance_along(covariance[m.point], made.normal));
    u += p.x, v += p.y, squares += p.x * p.x + p.y * p.y;
  }
  const auto count = static_cast<double>(near.size());
  made.fit = sums.fit();
  made.centroid = std::hypot(u, v) / count / std::sqrt(squares / count + 1e-300);
  made.radius_m = unit * std::sqrt(2 * squares / count);  // of the disc with this rms radius
  made.chi_square = made.fit.residual / (count - 6);
  return made;
}

}  // namespace

ViewSurface::ViewSurface(const MeasuredPoints& points, std::uint32_t view, std::size_t samples, std::uint64_t seed)
    : tree_([&] {
        std::vector<Vec3> own;
        for (std::size_t i = 0; i < points.view.size(); ++i)
          if (points.view[i] == view) own.push_back(points.positions_m[i]);
        return own;
      }()),
      camera_m_(points.viewpoints_m[view][0]) {
  std::vector<double> sigmas;
  for (std::size_t i = 0; i < points.view.size(); ++i) {
    if (points.view[i] != view) continue;
    const std::array<double, 6>& c = points.covariance_m2[i];
    covariance_m2_.push_back(c);
    sigmas.push_back(std::sqrt(c[0] + c[3] + c[5]));
  }
  sigma_m_ = stats::median(sigmas);
  low_m_ = high_m_ = tree_[0];
  for (std::uint32_t i = 0; i < tree_.size(); ++i) {
    const Vec3 p = tree_[i];
    low_m_ = {std::min(low_m_.x, p.x), std::min(low_m_.y, p.y), std::min(low_m_.z, p.z)};
    high_m_ = {std::max(high_m_.x, p.x), std::max(high_m_.y, p.y), std::max(high_m_.z, p.z)};
  }
  choose_window();
  std::vector<std::uint32_t> order(tree_.size());
  std::iota(order.begin(), order.end(), std::uint32_t{0});
  Random random(seed, view);
  const std::size_t count = std::min(samples, order.size());
  for (std::size_t i = 0; i < count; ++i)
    std::swap(order[i], order[i + random.below(static_cast<std::uint32_t>(order.size() - i))]);
  std::vector<ViewFit> fits(count);
  parallel_for(
      0, count, [&](std::size_t i) { fits[i] = fit(tree_[order[i]]); }, 256);
  for (std::size_t i = 0; i < count; ++i)
    if (fits[i].good) samples_.push_back({order[i], fits[i].normal});
}

void ViewSurface::choose_window() {
  const std::size_t count = std::min<std::size_t>(probe_count, tree_.size());
  const auto probe = [&](std::size_t k) { return tree_[static_cast<std::uint32_t>(k * tree_.size() / count)]; };
  std::vector<double> distances(count), chi(count), slopes(count), radii(count);
  std::vector<PointTree::Neighbour> near;
  for (std::size_t k = 0; k < count; ++k)
    tree_.nearest(probe(k), 7, near), distances[k] = std::sqrt(near.back().squared);
  spacing_m_ = std::max(stats::median(distances), 1e-12);
  for (const std::size_t window : fit_points) {
    window_ = window;
    parallel_for(
        0, count,
        [&](std::size_t k) {
          const LocalSums s = sums_at(tree_, covariance_m2_, camera_m_, probe(k), window, spacing_m_);
          chi[k] = s.chi_square, radii[k] = s.radius_m;
          slopes[k] =
              s.fit.good
                  ? std::sqrt(std::max(1.0, s.chi_square) * (s.fit.variance_of_slope(0) + s.fit.variance_of_slope(1)))
                  : 1e300;
        },
        16);
    radius_m_ = stats::median(radii), chi_square_ = std::max(1.0, stats::median(chi));
    if (stats::median(slopes) <= usable_slope) return;
  }
}

ViewFit ViewSurface::fit(Vec3 at, std::vector<FitMember>* members) const {
  const LocalSums s = sums_at(tree_, covariance_m2_, camera_m_, at, window_, spacing_m_);
  ViewFit made{at, s.normal};
  if (!s.fit.good || s.centroid > beside || s.chi_square > fold * chi_square_ || s.radius_m > 3 * radius_m_)
    return made;
  const Basis basis(s.normal);
  made.point = at + s.normal * (s.fit.c[0] * spacing_m_);
  made.normal = normalized(basis.to_world({-s.fit.c[1], -s.fit.c[2], 1}));
  const double lean = dot(made.normal, s.normal);
  made.variance_m2 = spacing_m_ * spacing_m_ * s.fit.variance_of_height() * lean * lean;
  made.tangents = {-basis.t, -basis.b};
  made.slope_covariance = {chi_square_ * s.fit.inverse[7], chi_square_ * s.fit.inverse[8],
                           chi_square_ * s.fit.inverse[14]};
  made.good = true;
  if (members == nullptr) return made;
  members->clear();
  for (const PointTree::Neighbour& m : s.near) {
    const Vec3 p = basis.to_local(tree_[m.point] - at) / spacing_m_;
    const LocalQuadratic::Terms terms = LocalQuadratic::terms(p.x, p.y);
    double share = 0;
    for (std::size_t k = 0; k < terms.size(); ++k) share += s.fit.inverse[k] * terms[k];
    share *= spacing_m_ * spacing_m_ / variance_along(covariance_m2_[m.point], s.normal);
    members->push_back({m.point, share * lean});
  }
  return made;
}

double ViewSurface::variance_m2(std::uint32_t point, Vec3 direction) const {
  return variance_along(covariance_m2_[point], direction);
}

double ViewSurface::nearest_m(Vec3 at) const {
  std::vector<PointTree::Neighbour> near;
  tree_.nearest(at, 1, near);
  return std::sqrt(near.front().squared);
}

bool ViewSurface::may_reach(Vec3 at, double reach_m) const {
  return at.x > low_m_.x - reach_m && at.y > low_m_.y - reach_m && at.z > low_m_.z - reach_m &&
         at.x < high_m_.x + reach_m && at.y < high_m_.y + reach_m && at.z < high_m_.z + reach_m;
}

}  // namespace gonio::mesh
