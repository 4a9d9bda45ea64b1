// A sphere becomes rings of latitude and longitude: its texture coordinates, u along the longitude and v along the
// polar angle, are then exact at every vertex. A chord that spans the angle d leaves a gap of R (1 - cos(d / 2)); along
// both directions at once the middle of a quad lies about twice as deep.
#include "scene/exchange/geometry.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace gonio::scene {
namespace {

int rings_for(double sagitta) {
  return std::max(8, static_cast<int>(std::ceil(pi / (2 * std::sqrt(std::max(sagitta, 1e-9))))));
}

io::TriangleMesh sphere_triangles(double radius_m, int rings) {
  io::TriangleMesh mesh;
  const int sectors = 2 * rings;
  for (int i = 0; i <= rings; ++i)
    for (int j = 0; j <= sectors; ++j) {
      const bool pole = i == 0 || i == rings;
      const double theta = pi * i / rings, phi = 2 * pi * j / sectors - pi;
      const double z = i == 0 ? 1 : i == rings ? -1 : std::cos(theta), r = pole ? 0 : std::sin(theta);
      // The seam's two columns stand at the same places, to the last bit.
      const double x = j == 0 || j == sectors ? -1 : std::cos(phi), y = j == 0 || j == sectors ? 0 : std::sin(phi);
      mesh.normals.push_back({r * x, r * y, z});
      mesh.positions_m.push_back(mesh.normals.back() * radius_m);
      mesh.texture.push_back({static_cast<double>(j) / sectors, 1 - static_cast<double>(i) / rings});
    }
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < sectors; ++j) {
      const auto a = static_cast<std::uint32_t>(i * (sectors + 1) + j), b = a + 1,
                 c = a + static_cast<std::uint32_t>(sectors) + 1, d = c + 1;
      if (i > 0) mesh.triangles.push_back({a, c, b});
      if (i + 1 < rings) mesh.triangles.push_back({b, c, d});
    }
  return mesh;
}

io::TriangleMesh plane_triangles(const Plane& plane) {
  io::TriangleMesh mesh;
  for (const double v : {0.0, 1.0})
    for (const double u : {0.0, 1.0}) {
      mesh.positions_m.push_back({(u - 0.5) * plane.size_x_m, (v - 0.5) * plane.size_y_m, 0});
      mesh.texture.push_back({u, v});
    }
  mesh.triangles = {{0, 1, 3}, {0, 3, 2}};
  return mesh;
}

template <class T>
void append(std::string& bytes, T value) {
  static_assert(std::endian::native == std::endian::little);
  char raw[sizeof(T)];
  std::memcpy(raw, &value, sizeof(T));
  bytes.append(raw, sizeof(T));
}

}  // namespace

double sagitta_of_sphere(double largest_sagitta) {
  return 2 * (1 - std::cos(pi / (2 * rings_for(largest_sagitta))));
}

io::TriangleMesh triangles_of(const Shape& shape, double largest_sagitta) {
  if (const auto* sphere = std::get_if<Sphere>(&shape))
    return sphere_triangles(sphere->radius_m, rings_for(largest_sagitta));
  if (const auto* plane = std::get_if<Plane>(&shape)) return plane_triangles(*plane);
  const mesh::Mesh& mesh = *std::get<std::shared_ptr<const mesh::Mesh>>(shape);
  io::TriangleMesh triangles;
  triangles.positions_m = mesh.positions_m;
  triangles.normals = mesh.normals;
  triangles.texture = mesh.texture;
  triangles.triangles = mesh.triangles;
  return triangles;
}

std::string compact_ply(const io::TriangleMesh& mesh) {
  const bool normals = !mesh.normals.empty(), texture = !mesh.texture.empty();
  std::string bytes = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                      std::to_string(mesh.positions_m.size()) +
                      "\nproperty float x\nproperty float y\nproperty float z\n";
  if (normals) bytes += "property float nx\nproperty float ny\nproperty float nz\n";
  if (texture) bytes += "property float s\nproperty float t\n";
  bytes += "element face " + std::to_string(mesh.triangles.size()) +
           "\nproperty list uchar int vertex_indices\nend_header\n";
  const auto vector = [&](Vec3 v) {
    for (const double c : {v.x, v.y, v.z}) append(bytes, static_cast<float>(c));
  };
  for (std::size_t i = 0; i < mesh.positions_m.size(); ++i) {
    vector(mesh.positions_m[i]);
    if (normals) vector(mesh.normals[i]);
    if (!texture) continue;
    append(bytes, static_cast<float>(mesh.texture[i].x));
    append(bytes, static_cast<float>(mesh.texture[i].y));
  }
  for (const auto& triangle : mesh.triangles) {
    bytes.push_back(3);
    for (const std::uint32_t vertex : triangle) append(bytes, static_cast<std::int32_t>(vertex));
  }
  return bytes;
}

}  // namespace gonio::scene
