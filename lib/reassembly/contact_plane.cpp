// Contact vertices and the contact plane. Near is measured to the surface, not to its vertices as in the thesis: for
// dense meshes that is the same, and a box has no vertices where it stands on its face.
#include "reassembly/contact_plane.h"

#include <algorithm>
#include <cmath>

#include "linear/geom_matrices.h"
#include "linear/symmetric_eigen.h"
#include "mesh/triangle_tree.h"
#include "stats/intervals.h"

namespace gonio::reassembly::contact {
namespace {

// Least squares of distances along the normal, repeated with Cauchy's weights on the scale of the residuals' median: a
// fold that stands beside the foot does not tilt the plane. Nothing where the points lie on a line, or as thick as
// wide.
std::optional<Vec3> normal_of_plane(const std::vector<Vec3>& points) {
  if (points.size() < 3) return {};
  std::vector<double> weight(points.size(), 1);
  std::optional<Vec3> normal;
  for (int round = 0; round < 10; ++round) {
    Vec3 middle{};
    double sum = 0;
    for (std::size_t i = 0; i < points.size(); ++i) middle += weight[i] * points[i], sum += weight[i];
    middle = middle / sum;
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d d = linear::as_eigen(points[i] - middle);
      spread += weight[i] * d * d.transpose();
    }
    const linear::SymmetricEigen<Eigen::Matrix3d> pairs(spread);
    const auto& along = pairs.eigenvalues();
    if (!(along[1] > 1e-4 * along[2]) || along[0] > 0.5 * along[1]) return {};
    const Eigen::Vector3d n = pairs.eigenvectors().col(0);
    normal = Vec3{n.x(), n.y(), n.z()};
    std::vector<double> off;
    for (const Vec3& p : points) off.push_back(std::abs(dot(*normal, p - middle)));
    const double scale = 2.4 * stats::sigma_of_median * stats::median(off);
    if (!(scale > 0)) return normal;
    for (std::size_t i = 0; i < points.size(); ++i) weight[i] = 1 / (1 + (off[i] / scale) * (off[i] / scale));
  }
  return normal;
}

// Where the points say nothing, an edge on one large face: against the mean normal of the soft faces that are near.
std::optional<Vec3> down_of_faces(const io::TriangleMesh& soft, const io::TriangleMesh& hard,
                                  const mesh::TriangleTree& to_soft, double limit_m) {
  Vec3 up{};
  const Vec3 middle = extent_of(hard).middle;
  for (const Vec3& p : hard.positions_m) {
    const auto at = to_soft.nearest(p, limit_m);
    if (!(at.distance_m <= limit_m)) continue;
    const auto& [a, b, c] = soft.triangles[at.triangle];
    const Vec3 n = cross(soft.positions_m[b] - soft.positions_m[a], soft.positions_m[c] - soft.positions_m[a]);
    if (norm(n) > 0) up += normalized(n) * (dot(n, middle - soft.positions_m[a]) > 0 ? 1.0 : -1.0);
  }
  if (!(norm(up) > 0)) return {};
  return -normalized(up);
}

}  // namespace

Extent extent_of(const io::TriangleMesh& mesh) {
  if (mesh.positions_m.empty()) return {};
  Vec3 low = mesh.positions_m.front(), high = low;
  for (const Vec3& p : mesh.positions_m) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return {(low + high) / 2, norm(high - low)};
}

Near near_parts(const io::TriangleMesh& soft, const io::TriangleMesh& hard, double limit_m, std::optional<Vec3> given) {
  Near near{{}, {}, given};
  const mesh::TriangleTree to_hard(hard.positions_m, hard.triangles), to_soft(soft.positions_m, soft.triangles);
  std::vector<std::uint32_t> nearest;
  std::vector<Vec3> points;
  for (std::uint32_t v = 0; v < soft.positions_m.size(); ++v)
    if (const auto at = to_hard.nearest(soft.positions_m[v], limit_m); at.distance_m <= limit_m) {
      near.soft.push_back(v);
      nearest.push_back(at.triangle);
      points.push_back(soft.positions_m[v]);
    }
  if (!near.down) {
    constexpr std::size_t enough = 12;
    std::optional<Vec3> normal;
    if (points.size() >= enough) normal = normal_of_plane(points);
    if (!normal) {  // a mesh so coarse that its vertices lie elsewhere: what of its faces is near as well
      for (const Vec3& p : hard.positions_m)
        if (const auto at = to_soft.nearest(p, limit_m); at.distance_m <= limit_m) points.push_back(at.at.point);
      normal = normal_of_plane(points);
    }
    if (normal) {
      Vec3 middle{};
      for (const Vec3& p : points) middle += p / static_cast<double>(points.size());
      near.down = dot(*normal, extent_of(hard).middle - middle) > 0 ? -*normal : *normal;
    } else {
      near.down = down_of_faces(soft, hard, to_soft, limit_m);
    }
    if (!near.down) return near;
  }
  for (const std::uint32_t t : nearest) {
    const auto& f = hard.triangles[t];
    near.corner.push_back(
        *std::ranges::max_element(f, {}, [&](std::uint32_t v) { return dot(*near.down, hard.positions_m[v]); }));
  }
  return near;
}

}  // namespace gonio::reassembly::contact
