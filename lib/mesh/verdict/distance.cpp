// Points over `from`: the k-th lies where the running area passes (k + u) / samples of the whole (stratified), evenly
// within its triangle. The side of `to` is told by the pseudonormal of the nearest face, edge or vertex, which is right
// for every closed mesh (Baerentzen & Aanaes 2005): edges take the sum of both normals, vertices the sum weighted by
// angles.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "base/random.h"
#include "mesh/adjacency.h"
#include "mesh/mesh.h"
#include "mesh/triangle_tree.h"
#include "mesh/verdict.h"

namespace gonio::mesh {
namespace {

Vec3 area_vector(const io::TriangleMesh& mesh, std::size_t t) {
  const auto& [a, b, c] = mesh.triangles[t];
  const Vec3 p = mesh.positions_m[a];
  return cross(mesh.positions_m[b] - p, mesh.positions_m[c] - p) / 2;
}

std::vector<Vec3> spread_points(const io::TriangleMesh& mesh, std::size_t samples, std::uint64_t seed) {
  std::vector<double> running(mesh.triangles.size());
  double sum = 0;
  for (std::size_t t = 0; t < running.size(); ++t) running[t] = sum += norm(area_vector(mesh, t));
  std::vector<Vec3> points;
  if (!(sum > 0)) return points;
  points.reserve(samples);
  for (std::size_t k = 0; k < samples; ++k) {
    Random random(seed, k);
    const double at = (static_cast<double>(k) + random.uniform()) / static_cast<double>(samples) * sum;
    const auto found = std::upper_bound(running.begin(), running.end(), at);
    const auto t = std::min(static_cast<std::size_t>(found - running.begin()), running.size() - 1);
    const double root = std::sqrt(random.uniform()), v = random.uniform();
    const auto& [a, b, c] = mesh.triangles[t];
    points.push_back(mesh.positions_m[a] * (1 - root) + mesh.positions_m[b] * (root * (1 - v)) +
                     mesh.positions_m[c] * (root * v));
  }
  return points;
}

// Normals that tell the side of a point whose nearest point lies in a face, on an edge or at a vertex.
class Sides {
 public:
  explicit Sides(const io::TriangleMesh& mesh)
      : mesh_(mesh),
        at_vertices_(averaged_by_angle(mesh)),
        behind_(neighbours_of_faces(mesh.triangles, mesh.positions_m.size())) {}
  double sign(Vec3 point, const TriangleTree::Nearest& nearest) const {
    return dot(point - nearest.at.point, pseudonormal(nearest)) < 0 ? -1 : 1;
  }

 private:
  static Vec3 unit_normal(const io::TriangleMesh& mesh, std::size_t t) {
    const Vec3 n = area_vector(mesh, t);
    const double length = norm(n);
    return length > 0 ? n / length : Vec3{};
  }
  static std::vector<Vec3> averaged_by_angle(const io::TriangleMesh& mesh) {
    std::vector<Vec3> sum(mesh.positions_m.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
      const Vec3 n = unit_normal(mesh, t);
      for (std::size_t c = 0; c < 3; ++c) {
        const Vec3 here = mesh.positions_m[mesh.triangles[t][c]];
        const Vec3 a = mesh.positions_m[mesh.triangles[t][(c + 1) % 3]] - here;
        const Vec3 b = mesh.positions_m[mesh.triangles[t][(c + 2) % 3]] - here;
        sum[mesh.triangles[t][c]] += n * std::atan2(norm(cross(a, b)), dot(a, b));
      }
    }
    return sum;
  }
  Vec3 pseudonormal(const TriangleTree::Nearest& nearest) const {
    const auto& w = nearest.at.weights;
    const auto t = nearest.triangle;
    for (std::size_t c = 0; c < 3; ++c)
      if (w[(c + 1) % 3] == 0 && w[(c + 2) % 3] == 0) return at_vertices_[mesh_.triangles[t][c]];
    for (std::size_t c = 0; c < 3; ++c)
      if (w[(c + 2) % 3] == 0 && behind_[t][c] != nobody)
        return unit_normal(mesh_, t) + unit_normal(mesh_, behind_[t][c]);
    return unit_normal(mesh_, t);
  }
  const io::TriangleMesh& mesh_;
  std::vector<Vec3> at_vertices_;
  std::vector<Corners> behind_;
};

std::vector<double> signed_distances(const std::vector<Vec3>& points, const TriangleTree& tree, const Sides& sides) {
  std::vector<double> found(points.size());
  parallel_for(
      0, points.size(),
      [&](std::size_t i) {
        const auto nearest = tree.nearest(points[i]);
        found[i] = sides.sign(points[i], nearest) * nearest.distance_m;
      },
      256);
  return found;
}

}  // namespace

std::vector<double> signed_distances(const std::vector<Vec3>& points_m, const io::TriangleMesh& to) {
  if (to.triangles.empty())
    throw Error(Exit::data, "mesh", "a mesh without triangles has no distance", "give meshes with a surface");
  return signed_distances(points_m, TriangleTree(to.positions_m, to.triangles), Sides(to));
}

Distance distance(const io::TriangleMesh& from, const io::TriangleMesh& to, std::size_t samples, std::uint64_t seed) {
  if (from.triangles.empty() || to.triangles.empty())
    throw Error(Exit::data, "mesh", "a mesh without triangles has no distance", "give meshes with a surface");
  const TriangleTree tree(to.positions_m, to.triangles);
  const Sides sides(to);
  std::vector<double> all = signed_distances(spread_points(from, samples, seed), tree, sides);
  Distance result;
  result.samples = all.size();
  double squares = 0;
  for (double& d : all) {
    squares += d * d;
    result.mean_signed_m += d;
    d = std::abs(d);
    result.mean_m += d;
    result.largest_m = std::max(result.largest_m, d);
  }
  if (!all.empty()) {
    const auto n = static_cast<double>(all.size());
    result.rms_m = std::sqrt(squares / n);
    result.mean_signed_m /= n;
    result.mean_m /= n;
    const auto rank = all.begin() + static_cast<std::ptrdiff_t>(0.99 * (n - 1));
    std::nth_element(all.begin(), rank, all.end());
    result.p99_m = *rank;
  }
  std::vector<bool> used(from.positions_m.size());
  for (const Corners& t : from.triangles)
    for (const std::uint32_t v : t) used[v] = true;
  std::vector<Vec3> corners;
  for (std::size_t v = 0; v < used.size(); ++v)
    if (used[v]) corners.push_back(from.positions_m[v]);
  for (const double d : signed_distances(corners, tree, sides))
    result.largest_m = std::max(result.largest_m, std::abs(d));
  return result;
}

}  // namespace gonio::mesh
