#include "mesh/reconstruct/oriented_points.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "mesh/reconstruct/poisson_disk.h"
#include "stats/intervals.h"

namespace gonio::mesh {
namespace {

constexpr std::size_t at_once = 256;  // samples of a chunk

OrientedPoints oriented_view(const std::vector<Vec3>& positions, Vec3 camera, const ReconstructionWish& wish) {
  OrientedPoints made{positions, std::vector<Vec3>(positions.size())};
  const PointTree all(positions);
  std::vector<Vec3> places;
  for (const std::uint32_t i : poisson_disk(all, wish.samples, wish.seed)) places.push_back(positions[i]);
  const PointTree samples(std::move(places));
  std::vector<Vec3> normals(samples.size());
  parallel_for(
      0, normals.size(),
      [&](std::size_t s) {
        const Vec3 at = samples[static_cast<std::uint32_t>(s)];
        std::vector<PointTree::Neighbour> near;
        samples.nearest(at, wish.neighbours, near);
        const Vec3 n = normal_of_plane(samples, near);
        normals[s] = dot(n, camera - at) < 0 ? -n : n;
      },
      at_once);
  parallel_for(
      0, positions.size(),
      [&](std::size_t i) {
        std::vector<PointTree::Neighbour> near;
        samples.nearest(positions[i], 1, near);
        made.normals[i] = normals[near.front().point];
      },
      at_once);
  return made;
}

}  // namespace

OrientedPoints oriented_by_planes(const MeasuredPoints& points, const ReconstructionWish& wish) {
  OrientedPoints made;
  for (std::size_t v = 0; v < points.viewpoints_m.size(); ++v) {
    std::vector<Vec3> own;
    for (std::size_t i = 0; i < points.view.size(); ++i)
      if (points.view[i] == v) own.push_back(points.positions_m[i]);
    if (own.empty()) continue;
    const OrientedPoints view = oriented_view(own, points.viewpoints_m[v][0], wish);
    made.positions_m.insert(made.positions_m.end(), view.positions_m.begin(), view.positions_m.end());
    made.normals.insert(made.normals.end(), view.normals.begin(), view.normals.end());
  }
  return made;
}

OrientedPoints oriented_by_surface(const PointTree& tree, const PointSurface& surface, const ReconstructionWish& wish) {
  const std::vector<std::uint32_t> samples = poisson_disk(tree, wish.samples, wish.seed);
  std::vector<PointFit> fits(samples.size());
  parallel_for(
      0, samples.size(),
      [&](std::size_t s) {
        const Vec3 at = tree[samples[s]];
        fits[s] = surface.fit(at, surface.plane_normal(samples[s]));
        // The plane's normal is a guess, and the quadratic stands upright on it.
        if (fits[s].good) fits[s] = surface.fit(fits[s].point, fits[s].normal);
      },
      at_once);
  std::vector<double> sigmas;
  for (const PointFit& fit : fits)
    if (fit.good) sigmas.push_back(fit.sigma_m);
  OrientedPoints made;
  if (sigmas.empty()) return made;
  const double usual = stats::median(sigmas);
  made.by_length = true;
  for (const PointFit& fit : fits) {
    if (!fit.good) continue;
    made.positions_m.push_back(fit.point);
    made.normals.push_back(fit.normal * std::clamp(usual / std::max(fit.sigma_m, 1e-300), 0.5, 2.0));
  }
  return made;
}

}  // namespace gonio::mesh
