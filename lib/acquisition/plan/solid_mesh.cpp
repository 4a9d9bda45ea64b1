#include "acquisition/plan/solid_mesh.h"

#include <cmath>

namespace gonio::acquisition {
namespace {

constexpr std::uint32_t facets = 24, rings = 12;

// A stack of rings of `facets` corners about z, from the bottom up, closed by fans at both ends.
SolidMesh turned_profile(const std::vector<Vec2>& profile) {  // (radius, z)
  SolidMesh mesh;
  for (const Vec2 p : profile)
    for (std::uint32_t k = 0; k < facets; ++k) {
      const double a = 2 * pi * k / facets;
      mesh.vertices_m.push_back({p.x * std::cos(a), p.x * std::sin(a), p.y});
    }
  const auto last = static_cast<std::uint32_t>(profile.size()) - 1;
  for (std::uint32_t r = 0; r < last; ++r)
    for (std::uint32_t k = 0; k < facets; ++k) {
      const std::uint32_t a = r * facets + k, b = r * facets + (k + 1) % facets;
      mesh.triangles.push_back({a, b, b + facets}), mesh.triangles.push_back({a, b + facets, a + facets});
    }
  for (std::uint32_t k = 1; k + 1 < facets; ++k) {
    mesh.triangles.push_back({0, k + 1, k});
    mesh.triangles.push_back({last * facets, last * facets + k, last * facets + k + 1});
  }
  return mesh;
}

SolidMesh box_mesh(Vec3 sides) {
  SolidMesh mesh;
  for (int k = 0; k < 8; ++k)
    mesh.vertices_m.push_back(
        {(k & 1 ? 0.5 : -0.5) * sides.x, (k & 2 ? 0.5 : -0.5) * sides.y, (k & 4 ? 0.5 : -0.5) * sides.z});
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

}  // namespace

SolidMesh mesh_of(const Solid& solid) {
  if (solid.shape == Solid::Shape::box) return box_mesh(solid.sides_m);
  if (solid.shape == Solid::Shape::mesh) return {solid.vertices_m, solid.triangles};
  const double radius = solid.sides_m.x;
  std::vector<Vec2> profile;
  if (solid.shape == Solid::Shape::cylinder)
    return turned_profile({{radius, -solid.sides_m.y / 2}, {radius, solid.sides_m.y / 2}});
  for (std::uint32_t r = 1; r < rings; ++r) {
    const double a = pi * r / rings;
    profile.push_back({radius * std::sin(a), -radius * std::cos(a)});
  }
  return turned_profile(profile);
}

}  // namespace gonio::acquisition
