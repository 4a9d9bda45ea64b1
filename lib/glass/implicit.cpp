// See implicit.h.
#include "glass/implicit.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "io/volume.h"
#include "mesh/clean.h"
#include "volume/contour.h"

namespace gonio::glass {
namespace {

io::VolumeData sampled(const std::function<double(Vec3)>& field, double half, int cells) {
  io::VolumeData data;
  const auto n = static_cast<std::size_t>(cells) + 1;
  data.head.size = {n, n, n};
  data.head.type = io::VoxelType::f32;
  data.head.spacing_m = Vec3{2 * half / cells, 2 * half / cells, 2 * half / cells};
  data.values.reserve(n * n * n);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t j = 0; j < n; ++j)
      for (std::size_t i = 0; i < n; ++i) {
        const auto at = [&](std::size_t index) { return half * (2 * static_cast<double>(index) / cells - 1); };
        const auto value = static_cast<float>(field({at(i), at(j), at(k)}));
        const bool border = i == 0 || j == 0 || k == 0 || i + 1 == n || j + 1 == n || k + 1 == n;
        if (border && value > 0) throw Error(Exit::data, "body", "leaves the cube that it is looked for in");
        data.values.push_back(value);
      }
  return data;
}

// Triangles that hang together by vertices, the most of them.
void keep_largest(io::TriangleMesh& mesh) {
  std::vector<std::uint32_t> root(mesh.positions_m.size());
  for (std::uint32_t i = 0; i < root.size(); ++i) root[i] = i;
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v] = root[root[v]];
    return v;
  };
  for (const auto& [a, b, c] : mesh.triangles) root[find(a)] = find(c), root[find(b)] = find(c);
  std::vector<std::size_t> count(root.size());
  for (const auto& t : mesh.triangles) ++count[find(t[0])];
  const auto best = static_cast<std::uint32_t>(std::ranges::max_element(count) - count.begin());
  io::TriangleMesh kept;
  std::vector<std::uint32_t> number(root.size(), 0);
  for (std::uint32_t v = 0; v < root.size(); ++v)
    if (find(v) == best) {
      number[v] = static_cast<std::uint32_t>(kept.positions_m.size());
      kept.positions_m.push_back(mesh.positions_m[v]);
    }
  for (const auto& [a, b, c] : mesh.triangles)
    if (find(a) == best) kept.triangles.push_back({number[a], number[b], number[c]});
  mesh = std::move(kept);
}

}  // namespace

io::TriangleMesh body_of(const std::function<double(Vec3)>& field, double half, int cells, std::size_t faces,
                         bool smooth) {
  const volume::Contour surface = volume::contour(*io::source_of(sampled(field, half, cells)), {.threshold = 0});
  if (surface.triangles.empty()) throw Error(Exit::data, "body", "is empty");
  io::TriangleMesh mesh;
  for (const auto& p : surface.positions)
    mesh.positions_m.push_back(Vec3{p[0], p[1], p[2]} * (2 * half / cells) - Vec3{half, half, half});
  mesh.triangles = surface.triangles;
  keep_largest(mesh);
  if (mesh.triangles.size() > faces) mesh::decimate(mesh, faces);
  if (!smooth) return mesh;
  const double step = half / cells / 4;
  for (const Vec3& p : mesh.positions_m) {
    const auto along = [&](Vec3 d) { return field(p - d * step) - field(p + d * step); };
    mesh.normals.push_back(normalized(Vec3{along({1, 0, 0}), along({0, 1, 0}), along({0, 0, 1})}));
  }
  return mesh;
}

double distance_to_box(Vec3 p, Vec3 half, double rounding) {
  const Vec3 q{std::abs(p.x) - half.x + rounding, std::abs(p.y) - half.y + rounding, std::abs(p.z) - half.z + rounding};
  const Vec3 out{std::max(q.x, 0.0), std::max(q.y, 0.0), std::max(q.z, 0.0)};
  return norm(out) + std::min(max_component(q), 0.0) - rounding;
}

double distance_to_capsule(Vec3 p, Vec3 a, Vec3 b, double radius) {
  const Vec3 along = b - a;
  const double t = std::clamp(dot(p - a, along) / dot(along, along), 0.0, 1.0);
  return norm(p - a - along * t) - radius;
}

double distance_to_torus(Vec3 p, Vec3 axis, double ring, double tube) {
  const double up = dot(p, axis);
  return std::hypot(norm(p - axis * up) - ring, up) - tube;
}

double distance_to_cylinder(Vec3 p, Vec3 axis, double radius, double half) {
  const double up = std::abs(dot(p, axis)) - half, out = norm(p - axis * dot(p, axis)) - radius;
  return std::hypot(std::max(up, 0.0), std::max(out, 0.0)) + std::min(std::max(up, out), 0.0);
}

double blended(double a, double b, double width) {
  const double h = std::max(width - std::abs(a - b), 0.0) / width;
  return std::min(a, b) - h * h * width / 4;
}

}  // namespace gonio::glass
