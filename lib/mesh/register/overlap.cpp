#include "mesh/register/overlap.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "base/parallel.h"
#include "linear/geom_matrices.h"
#include "stats/intervals.h"

namespace gonio::mesh {
namespace {

constexpr double alike = 0.7;  // least cosine between both normals: 45 degrees
constexpr double seen = 0.15;  // least cosine between a normal and the way to a camera that sees the place
constexpr double reach_spacings = 8, reach_sigmas = 6;
constexpr double patch_radii = 5;  // of a fit's points: shared ones then matter at the edges alone
constexpr double wished_patches = 300;

bool sees(Vec3 camera, Vec3 at, Vec3 normal) {
  return dot(normal, camera - at) > seen * norm(camera - at);
}

double whitened(const OverlapPoint& p) {
  return p.residual.off_m / p.residual.sigma_m;
}

// About zero, not less than one.
double spread_of(const std::vector<const ViewOverlap*>& both) {
  std::vector<double> sizes;
  for (const ViewOverlap* overlap : both)
    for (const OverlapPoint& p : overlap->points) sizes.push_back(std::abs(whitened(p)));
  return sizes.empty() ? 1 : std::max(1.0, stats::sigma_of_median * stats::median(sizes));
}

void add(const ViewOverlap& overlap, const MotionScale& scale, double sign, PairSums& sums) {
  for (const OverlapPoint& p : overlap.points) {
    const double z = whitened(p), variance = p.residual.sigma_m * p.residual.sigma_m, weight = p.weight;
    const Vector6 j = sign * slopes_of(p.residual.at_m, p.normal, scale);
    const Vec3 cell = (p.residual.at_m - scale.centre_m) / scale.patch_m;
    PatchSums& patch = sums.patches[{static_cast<int>(std::floor(cell.x)), static_cast<int>(std::floor(cell.y)),
                                     static_cast<int>(std::floor(cell.z))}];
    patch.residuals += 1, patch.squares += weight * z * z;
    patch.pull -= weight * p.residual.off_m / variance * j;
    patch.squared += weight / variance * j * j.transpose();
    const Vector6 u = slopes_of(p.residual.at_m, p.tangents[0], scale),
                  v = slopes_of(p.residual.at_m, p.tangents[1], scale);
    const auto& c = p.slope_covariance;
    sums.by_noise +=
        weight / variance *
        (c[0] * u * u.transpose() + c[1] * (u * v.transpose() + v * u.transpose()) + c[2] * v * v.transpose());
  }
}

}  // namespace

double usual_reach_m(const std::vector<ViewSurface>& surfaces) {
  double spacing = 0, sigma = 0;
  for (const ViewSurface& s : surfaces)
    spacing = std::max(spacing, s.spacing_m()), sigma = std::max(sigma, s.sigma_m());
  return reach_spacings * spacing + reach_sigmas * sigma;
}

ViewOverlap overlap_of(const std::vector<ViewSurface>& surfaces, const std::vector<ViewMotion>& motions,
                       std::size_t view, std::size_t other, double reach_m) {
  const ViewSurface &own = surfaces[view], &target = surfaces[other];
  const ViewMotion there = inverse(motions[other]) * motions[view], back = inverse(there);
  ViewOverlap made{view, other, {}, own.samples().size()};
  std::vector<OverlapPoint> all(own.samples().size());
  parallel_for(
      0, all.size(),
      [&](std::size_t i) {
        const ViewSurface::Sample& sample = own.samples()[i];
        const Vec3 at = there * own[sample.point], own_normal = there.rotate(sample.normal);
        if (!target.may_reach(at, reach_m) || !sees(target.camera_m(), at, own_normal)) return;
        if (target.nearest_m(at) > reach_m) return;
        const ViewFit fit = target.fit(at);
        if (!fit.good || dot(fit.normal, own_normal) < alike || !sees(target.camera_m(), at, fit.normal)) return;
        const double off = dot(at - fit.point, fit.normal);
        const Vec3 in_own = back.rotate(fit.normal);
        if (std::abs(off) > reach_m || !sees(own.camera_m(), own[sample.point], in_own)) return;
        OverlapPoint& p = all[i];
        p.point = sample.point;
        p.residual.view = static_cast<std::uint32_t>(view), p.residual.other = static_cast<std::uint32_t>(other);
        p.residual.at_m = motions[other] * at;
        p.residual.off_m = off;
        p.residual.sigma_m = std::sqrt(fit.variance_m2 + own.variance_m2(sample.point, in_own));
        p.normal = motions[other].rotate(fit.normal);
        for (std::size_t k = 0; k < 2; ++k) p.tangents[k] = motions[other].rotate(fit.tangents[k]);
        p.slope_covariance = fit.slope_covariance;
      },
      64);
  for (OverlapPoint& p : all)
    if (p.residual.sigma_m > 0) made.points.push_back(p);
  return made;
}

MotionScale scale_of(const std::vector<ViewOverlap>& overlaps, const std::vector<ViewSurface>& surfaces) {
  MotionScale scale;
  double count = 0, square = 0, radius = 0, spacing = 0;
  for (const ViewOverlap& o : overlaps)
    for (const OverlapPoint& p : o.points) scale.centre_m += p.residual.at_m, ++count;
  if (count == 0) return scale;
  scale.centre_m *= 1 / count;
  for (const ViewOverlap& o : overlaps)
    for (const OverlapPoint& p : o.points) {
      const Vec3 d = p.residual.at_m - scale.centre_m;
      square += dot(d, d) / count;
    }
  for (const ViewSurface& s : surfaces)
    radius = std::max(radius, s.radius_m()), spacing = std::max(spacing, s.spacing_m());
  scale.length_m = std::max(std::sqrt(square), 1e-9);
  // A surface about the middle with this rms distance has about this area: that of a disc.
  scale.patch_m = std::max(patch_radii * radius, std::sqrt(2 * pi * square / wished_patches));
  return scale;
}

std::map<std::pair<std::size_t, std::size_t>, std::vector<const ViewOverlap*>> by_pair(
    const std::vector<ViewOverlap>& overlaps) {
  std::map<std::pair<std::size_t, std::size_t>, std::vector<const ViewOverlap*>> pairs;
  for (const ViewOverlap& o : overlaps)
    if (!o.points.empty()) pairs[std::minmax(o.view, o.other)].push_back(&o);
  return pairs;
}

void weigh(std::vector<ViewOverlap>& overlaps, double width) {
  std::map<std::pair<std::size_t, std::size_t>, double> limits;
  for (const auto& [views, both] : by_pair(overlaps)) limits[views] = width * spread_of(both);
  for (ViewOverlap& o : overlaps)
    for (OverlapPoint& p : o.points)
      p.weight = std::min(1.0, limits.at(std::minmax(o.view, o.other)) / std::max(std::abs(whitened(p)), 1e-300));
}

std::vector<PairSums> sums_of(const std::vector<ViewOverlap>& overlaps, const MotionScale& scale) {
  std::vector<PairSums> all;
  for (const auto& [views, both] : by_pair(overlaps)) {
    PairSums sums;
    sums.first = views.first, sums.second = views.second;
    for (const ViewOverlap* o : both) add(*o, scale, o->view == sums.first ? 1 : -1, sums);
    for (const auto& [at, patch] : sums.patches) {
      sums.all.residuals += patch.residuals, sums.all.squares += patch.squares;
      sums.all.pull += patch.pull, sums.all.squared += patch.squared;
    }
    all.push_back(std::move(sums));
  }
  return all;
}

Vector6 slopes_of(Vec3 at, Vec3 normal, const MotionScale& scale) {
  Vector6 j;
  j << linear::as_eigen(cross(at - scale.centre_m, normal) / scale.length_m), linear::as_eigen(normal);
  return j;
}

}  // namespace gonio::mesh
