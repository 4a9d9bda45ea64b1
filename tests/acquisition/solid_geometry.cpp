// See solid_geometry.h.
#include "acquisition/solid_geometry.h"

#include <algorithm>
#include <cmath>

#include "acquisition/robot_meshes.h"

namespace gonio::tests {
namespace {

using acquisition::Solid;

double outside_of(double a, double b, double c) {  // of a corner whose faces are a, b, c away
  const Vec3 out{std::max(a, 0.0), std::max(b, 0.0), std::max(c, 0.0)};
  return norm(out) + std::min(std::max({a, b, c}), 0.0);
}

int pieces(double length, double spacing) {
  return std::max(1, static_cast<int>(std::ceil(length / spacing)));
}

void add_disc(std::vector<Vec3>& points, double radius, double z, double spacing) {
  const int rings = pieces(radius, spacing);
  for (int k = 0; k <= rings; ++k) {
    const double r = radius * k / rings;
    const int around = pieces(2 * pi * r, spacing);
    for (int i = 0; i < around; ++i)
      points.push_back({r * std::cos(2 * pi * i / around), r * std::sin(2 * pi * i / around), z});
  }
}

}  // namespace

double signed_distance(const Solid& solid, Vec3 p) {
  const Vec3 s = solid.sides_m;
  if (solid.shape == Solid::Shape::ball) return norm(p) - s.x;
  if (solid.shape == Solid::Shape::cylinder)
    return outside_of(std::hypot(p.x, p.y) - s.x, std::fabs(p.z) - s.y / 2, -1e300);
  return outside_of(std::fabs(p.x) - s.x / 2, std::fabs(p.y) - s.y / 2, std::fabs(p.z) - s.z / 2);
}

Vec3 nearest_in(const Solid& solid, Vec3 p) {
  const Vec3 s = solid.sides_m;
  if (solid.shape == Solid::Shape::ball) return norm(p) > s.x ? p * (s.x / norm(p)) : p;
  if (solid.shape == Solid::Shape::cylinder) {
    const double r = std::hypot(p.x, p.y), share = r > s.x ? s.x / r : 1;
    return {p.x * share, p.y * share, std::clamp(p.z, -s.y / 2, s.y / 2)};
  }
  return {std::clamp(p.x, -s.x / 2, s.x / 2), std::clamp(p.y, -s.y / 2, s.y / 2), std::clamp(p.z, -s.z / 2, s.z / 2)};
}

double support(const Solid& solid, Vec3 n) {
  const Vec3 s = solid.sides_m;
  if (solid.shape == Solid::Shape::ball) return s.x * norm(n);
  if (solid.shape == Solid::Shape::cylinder) return s.x * std::hypot(n.x, n.y) + s.y / 2 * std::fabs(n.z);
  return (std::fabs(n.x) * s.x + std::fabs(n.y) * s.y + std::fabs(n.z) * s.z) / 2;
}

std::vector<Vec3> surface_points(const Solid& solid, double spacing) {
  std::vector<Vec3> points;
  const Vec3 s = solid.sides_m;
  if (solid.shape == Solid::Shape::mesh) {
    io::TriangleMesh mesh;
    mesh.positions_m = solid.vertices_m;
    mesh.triangles = solid.triangles;
    return points_on(mesh, spacing);
  }
  if (solid.shape == Solid::Shape::box) {
    const int n[3] = {pieces(s.x, spacing), pieces(s.y, spacing), pieces(s.z, spacing)};
    for (int i = 0; i <= n[0]; ++i)
      for (int j = 0; j <= n[1]; ++j)
        for (int k = 0; k <= n[2]; ++k)
          if (i == 0 || i == n[0] || j == 0 || j == n[1] || k == 0 || k == n[2])
            points.push_back(s * Vec3{double(i) / n[0] - 0.5, double(j) / n[1] - 0.5, double(k) / n[2] - 0.5});
    return points;
  }
  if (solid.shape == Solid::Shape::ball) {
    const int rows = pieces(pi * s.x, spacing);
    for (int i = 0; i <= rows; ++i) {
      const double t = pi * i / rows;
      const int around = pieces(2 * pi * s.x * std::sin(t), spacing);
      for (int k = 0; k < around; ++k)
        points.push_back(s.x * Vec3{std::sin(t) * std::cos(2 * pi * k / around),
                                    std::sin(t) * std::sin(2 * pi * k / around), std::cos(t)});
    }
    return points;
  }
  add_disc(points, s.x, -s.y / 2, spacing);
  add_disc(points, s.x, s.y / 2, spacing);
  const int rows = pieces(s.y, spacing), around = pieces(2 * pi * s.x, spacing);
  for (int i = 1; i < rows; ++i)
    for (int k = 0; k < around; ++k)
      points.push_back(
          {s.x * std::cos(2 * pi * k / around), s.x * std::sin(2 * pi * k / around), s.y * (double(i) / rows - 0.5)});
  return points;
}

}  // namespace gonio::tests
