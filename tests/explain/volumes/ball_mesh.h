// Balls as nets of longitudes and latitudes, for shapes that are believed.
#pragma once
#include "mesh/mesh.h"

namespace gonio::explain::volumes::tests {

// `hollow`: facing inwards, as the wall of a hollow does.
inline mesh::Mesh ball_mesh(Vec3 centre, double radius, bool hollow) {
  constexpr std::uint32_t around = 120, down = 60;
  mesh::Mesh mesh;
  for (std::uint32_t d = 0; d <= down; ++d)
    for (std::uint32_t a = 0; a < (d == 0 || d == down ? 1 : around); ++a) {
      const double t = pi * d / down, f = 2 * pi * a / around;
      mesh.positions_m.push_back(centre +
                                 Vec3{std::sin(t) * std::cos(f), std::sin(t) * std::sin(f), std::cos(t)} * radius);
    }
  const auto last = static_cast<std::uint32_t>(mesh.positions_m.size()) - 1;
  const auto index = [&](std::uint32_t d, std::uint32_t a) {
    return d == 0 ? 0 : d == down ? last : 1 + (d - 1) * around + a % around;
  };
  const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    mesh.triangles.push_back(hollow ? std::array{a, c, b} : std::array{a, b, c});
  };
  for (std::uint32_t d = 0; d < down; ++d)
    for (std::uint32_t a = 0; a < around; ++a) {
      if (d > 0) add(index(d, a), index(d + 1, a), index(d, a + 1));
      if (d + 1 < down) add(index(d, a + 1), index(d + 1, a), index(d + 1, a + 1));
    }
  mesh.normals = mesh::averaged_normals(mesh.positions_m, mesh.triangles);
  return mesh;
}

inline void join(mesh::Mesh& mesh, const mesh::Mesh& other) {
  const auto first = static_cast<std::uint32_t>(mesh.positions_m.size());
  mesh.positions_m.insert(mesh.positions_m.end(), other.positions_m.begin(), other.positions_m.end());
  mesh.normals.insert(mesh.normals.end(), other.normals.begin(), other.normals.end());
  for (const auto& t : other.triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

}  // namespace gonio::explain::volumes::tests
