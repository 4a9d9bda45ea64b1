#include "mesh/reconstruct/deviation.h"

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "mesh/adjacency.h"
#include "mesh/triangle_tree.h"
#include "stats/intervals.h"

namespace gonio::mesh {
namespace {

constexpr double reach_sigmas = 6, reach_spacings = 3;  // farther than both together: no surface of this point

struct Beside {  // a point and its foot
  double off = 0, sigma = 0;
  TriangleTree::Nearest foot{};
  bool found = false;
};

}  // namespace

void deviate(const MeasuredPoints& points, const PointSurface& surface, const io::TriangleMesh& mesh,
             Reconstruction& made) {
  made.deviation_m.assign(mesh.positions_m.size(), 0);
  made.deviation.bare = points.positions_m.size();
  if (mesh.triangles.empty()) return;
  const TriangleTree tree(mesh.positions_m, mesh.triangles);
  const std::vector<char> rim = rim_vertices(mesh.triangles, mesh.positions_m.size());
  std::vector<Beside> all(points.positions_m.size());
  parallel_for(
      0, all.size(),
      [&](std::size_t i) {
        const auto point = static_cast<std::uint32_t>(i);
        const Vec3 p = points.positions_m[i];
        const std::array<double, 6>& c = points.covariance_m2[i];
        const double reach = reach_sigmas * surface.noise_ratio() * std::sqrt(c[0] + c[3] + c[5]) +
                             reach_spacings * surface.spacing_m(point);
        Beside& own = all[i];
        own.foot = tree.nearest(p, reach);
        if (!(own.foot.distance_m <= reach)) return;
        const auto& t = mesh.triangles[own.foot.triangle];
        Vec3 n;
        for (std::size_t k = 0; k < 3; ++k) {
          if (own.foot.at.weights[k] > 0 && rim[t[k]] != 0) return;
          n += mesh.normals[t[k]] * own.foot.at.weights[k];
        }
        n = normalized(n);
        own.off = dot(p - own.foot.at.point, n);
        own.sigma = std::sqrt(surface.variance_m2(point, n));
        own.found = true;
      },
      256);
  std::vector<double> weight(mesh.positions_m.size(), 0), sum(mesh.positions_m.size(), 0), sizes;
  double squares = 0, whitened = 0;
  for (const Beside& b : all) {
    if (!b.found) continue;
    sizes.push_back(std::abs(b.off));
    squares += b.off * b.off, whitened += b.off * b.off / (b.sigma * b.sigma);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t v = mesh.triangles[b.foot.triangle][k];
      weight[v] += b.foot.at.weights[k], sum[v] += b.foot.at.weights[k] * b.off;
    }
  }
  for (std::size_t v = 0; v < sum.size(); ++v)
    if (weight[v] > 0) made.deviation_m[v] = static_cast<float>(sum[v] / weight[v]);
  PointDeviation& d = made.deviation;
  d.points = sizes.size();
  d.bare = all.size() - sizes.size();
  if (sizes.empty()) return;
  const auto count = static_cast<double>(sizes.size());
  d.rms_m = std::sqrt(squares / count), d.whitened = std::sqrt(whitened / count);
  d.median_m = stats::median(sizes), d.p95_m = stats::quantile(sizes, 0.95);
}

}  // namespace gonio::mesh
