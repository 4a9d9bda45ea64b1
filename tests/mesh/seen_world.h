// Clouds of a camera and a projector that look at meshes whose every place is known: rays in double precision, errors
// along the camera's ray as triangulation has them, and points only where both see the surface.
#pragma once
#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "base/random.h"
#include "mesh/reconstruct.h"
#include "mesh/triangle_tree.h"

namespace gonio::tests {

struct SeenFrom {  // a pinhole, its principal point in the middle; the projector stands to its right
  Vec3 camera{}, target{};
  double baseline_m = 0.12;
  int width = 200, height = 150;
  double f_px = 330;
  double projector_f_px = 1000, sigma_px = 0.1;  // of what is decoded
  double lateral_px = 0.02;                      // of the camera's own pixels
};

inline void see(const mesh::TriangleTree& tree, const io::TriangleMesh& truth, const SeenFrom& from, std::uint64_t seed,
                mesh::MeasuredPoints& points) {
  const Vec3 forward = normalized(from.target - from.camera);
  const Vec3 up = std::abs(forward.y) < 0.9 ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  const Vec3 right = normalized(cross(forward, up)), down = cross(forward, right);
  const Vec3 projector = from.camera + right * from.baseline_m;
  const auto view = static_cast<std::uint32_t>(points.viewpoints_m.size());
  points.viewpoints_m.push_back({from.camera, projector});
  struct Seen {
    bool both = false;
    Vec3 at{};
    std::array<double, 6> covariance{};
  };
  std::vector<Seen> all(static_cast<std::size_t>(from.width) * static_cast<std::size_t>(from.height));
  parallel_for(
      0, all.size(),
      [&](std::size_t i) {
        const double x = static_cast<double>(i % static_cast<std::size_t>(from.width)) - 0.5 * (from.width - 1),
                     y = static_cast<double>(i / static_cast<std::size_t>(from.width)) - 0.5 * (from.height - 1);
        const Vec3 ray = normalized(forward * from.f_px + right * x + down * y);
        const auto hit = tree.first_hit(from.camera, ray, 1e-6);
        if (!hit) return;
        const auto& t = truth.triangles[hit->triangle];
        const Vec3 a = truth.positions_m[t[0]], b = truth.positions_m[t[1]], c = truth.positions_m[t[2]];
        const Vec3 n = cross(b - a, c - a), at = from.camera + ray * hit->t, way = at - projector;
        if (dot(n, ray) >= 0 || dot(n, way) >= 0) return;
        const auto lit = tree.first_hit(projector, normalized(way), 1e-6);
        if (!lit || lit->t < norm(way) * (1 - 1e-6)) return;
        // Along the camera's ray the projector sees a step s as an angle s sin(alpha) / |way|.
        const double sine = norm(cross(ray, way)) / norm(way);
        const double along = norm(way) * from.sigma_px / (from.projector_f_px * sine),
                     across = hit->t * from.lateral_px / from.f_px;
        Random random(seed, i + 1000003 * view);
        const Vec3 noise{across * random.normal(), across * random.normal(), across * random.normal()};
        Seen& own = all[i];
        own.both = true;
        own.at = at + ray * (std::sqrt(along * along - across * across) * random.normal()) + noise;
        const double more = along * along - across * across, floor = across * across;
        own.covariance = {more * ray.x * ray.x + floor, more * ray.x * ray.y, more * ray.x * ray.z,
                          more * ray.y * ray.y + floor, more * ray.y * ray.z, more * ray.z * ray.z + floor};
      },
      256);
  for (const Seen& seen : all)
    if (seen.both) {
      points.positions_m.push_back(seen.at);
      points.covariance_m2.push_back(seen.covariance);
      points.view.push_back(view);
    }
}

}  // namespace gonio::tests
