// Normals beside those of a reference.
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/parallel.h"
#include "mesh/mesh.h"
#include "mesh/triangle_tree.h"
#include "mesh/verdict.h"

namespace gonio::mesh {
namespace {

std::vector<Vec3> normals_at_vertices(const io::TriangleMesh& mesh) {
  return mesh.normals.size() == mesh.positions_m.size() ? mesh.normals
                                                        : averaged_normals(mesh.positions_m, mesh.triangles);
}

}  // namespace

double normals_rms_rad(const io::TriangleMesh& mesh, const io::TriangleMesh& reference) {
  if (mesh.triangles.empty() || reference.triangles.empty())
    throw Error(Exit::data, "mesh", "a mesh without triangles has no normals", "give meshes with a surface");
  const TriangleTree tree(reference.positions_m, reference.triangles);
  const std::vector<Vec3> theirs = normals_at_vertices(reference), ours = normals_at_vertices(mesh);
  std::vector<double> squared(mesh.positions_m.size()), area(mesh.positions_m.size());
  for (const auto& t : mesh.triangles) {
    const Vec3 p = mesh.positions_m[t[0]];
    const double third = norm(cross(mesh.positions_m[t[1]] - p, mesh.positions_m[t[2]] - p)) / 6;
    for (const std::uint32_t v : t) area[v] += third;
  }
  const auto angle_at = [&](std::size_t v) {
    const TriangleTree::Nearest nearest = tree.nearest(mesh.positions_m[v]);
    const auto& corner = reference.triangles[nearest.triangle];
    Vec3 n{};
    for (std::size_t c = 0; c < 3; ++c) n += theirs[corner[c]] * nearest.at.weights[c];
    return std::atan2(norm(cross(n, ours[v])), dot(n, ours[v]));
  };
  parallel_for(
      0, squared.size(),
      [&](std::size_t v) {
        const double angle = area[v] > 0 ? angle_at(v) : 0;
        squared[v] = angle * angle;
      },
      256);
  double sum = 0, weight = 0;
  for (std::size_t v = 0; v < squared.size(); ++v) sum += area[v] * squared[v], weight += area[v];
  return weight > 0 ? std::sqrt(sum / weight) : 0;
}

}  // namespace gonio::mesh
