#include "mesh/reconstruct/envelope.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "mesh/reconstruct/point_tree.h"
#include "stats/intervals.h"

namespace gonio::mesh {
namespace {

constexpr double least_forward = 0.1;  // cosine from the middle of a view, below which its picture is not kept
constexpr int most_pixels = 4096;      // along a side
constexpr double pixel_spacings = 2;   // of a point from its fourth neighbour: few pixels among points are empty

// Where a ray meets the plane at distance 1, and its depth.
Vec3 projected(const Basis& basis, Vec3 from_viewpoint) {
  const Vec3 p = basis.to_local(from_viewpoint);
  return p.z > least_forward * norm(from_viewpoint) ? Vec3{p.x / p.z, p.y / p.z, p.z} : Vec3{0, 0, -1};
}

double usual_spacing(const std::vector<Vec3>& plane) {
  const PointTree tree(plane);
  const std::size_t probes = std::min<std::size_t>(1000, plane.size());
  std::vector<double> spacing;
  std::vector<PointTree::Neighbour> near;
  for (std::size_t k = 0; k < probes; ++k) {
    tree.nearest(plane[k * plane.size() / probes], 5, near);
    spacing.push_back(std::sqrt(near.back().squared));
  }
  return spacing.empty() ? 1 : std::max(1e-9, stats::median(spacing));
}

}  // namespace

Envelope::Envelope(const MeasuredPoints& points) {
  std::vector<std::vector<std::uint32_t>> members(points.viewpoints_m.size());
  for (std::size_t i = 0; i < points.view.size(); ++i) members[points.view[i]].push_back(static_cast<std::uint32_t>(i));
  std::vector<std::pair<Vec3, std::size_t>> all;
  for (std::size_t v = 0; v < members.size(); ++v)
    for (const Vec3 at : points.viewpoints_m[v]) all.emplace_back(at, v);
  pictures_.resize(all.size());
  parallel_for(0, all.size(),
               [&](std::size_t k) { pictures_[k] = picture_of(points, all[k].first, members[all[k].second]); });
}

Envelope::Picture Envelope::picture_of(const MeasuredPoints& points, Vec3 viewpoint,
                                       const std::vector<std::uint32_t>& members) {
  Picture made;
  made.viewpoint = viewpoint;
  Vec3 ahead;
  for (const std::uint32_t i : members) ahead += normalized(points.positions_m[i] - viewpoint);
  if (!(norm(ahead) > 0)) return made;
  made.basis = Basis(normalized(ahead));
  std::vector<Vec3> places, plane;
  for (const std::uint32_t i : members) {
    const Vec3 p = projected(made.basis, points.positions_m[i] - viewpoint);
    if (p.z > 0) places.push_back(p), plane.push_back({p.x, p.y, 0});
  }
  if (places.empty()) return made;
  double right = -1e300, high = -1e300;
  made.left = made.low = 1e300;
  for (const Vec3 p : places) {
    made.left = std::min(made.left, p.x), right = std::max(right, p.x);
    made.low = std::min(made.low, p.y), high = std::max(high, p.y);
  }
  made.pixel =
      std::max(pixel_spacings * usual_spacing(plane), std::max(right - made.left, high - made.low) / (most_pixels - 1));
  made.width = static_cast<int>((right - made.left) / made.pixel) + 1;
  made.height = static_cast<int>((high - made.low) / made.pixel) + 1;
  made.nearest.assign(static_cast<std::size_t>(made.width) * static_cast<std::size_t>(made.height), 0);
  for (const Vec3 p : places) {
    const int x = static_cast<int>((p.x - made.left) / made.pixel), y = static_cast<int>((p.y - made.low) / made.pixel);
    float& at =
        made.nearest[static_cast<std::size_t>(y) * static_cast<std::size_t>(made.width) + static_cast<std::size_t>(x)];
    const auto depth = static_cast<float>(p.z);
    at = at == 0 ? depth : std::min(at, depth);
  }
  return made;
}

bool Envelope::sees_through(const Picture& picture, Vec3 place_m, double margin_m) {
  const Vec3 p = projected(picture.basis, place_m - picture.viewpoint);
  if (!(p.z > 0)) return false;
  const double x = std::floor((p.x - picture.left) / picture.pixel),
               y = std::floor((p.y - picture.low) / picture.pixel);
  if (!(x >= 1 && y >= 1 && x < picture.width - 1 && y < picture.height - 1)) return false;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const float depth = picture.nearest[static_cast<std::size_t>(y + dy) * static_cast<std::size_t>(picture.width) +
                                          static_cast<std::size_t>(x + dx)];
      if (depth == 0 || depth < p.z + margin_m) return false;
    }
  return true;
}

bool Envelope::seen_through(Vec3 place_m, double margin_m) const {
  return std::ranges::any_of(pictures_,
                             [&](const Picture& picture) { return sees_through(picture, place_m, margin_m); });
}

}  // namespace gonio::mesh
