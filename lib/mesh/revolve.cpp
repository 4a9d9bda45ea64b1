// See revolve.h.
#include "mesh/revolve.h"

#include <cmath>

namespace gonio::mesh {

io::TriangleMesh revolved(const std::vector<ProfilePoint>& profile, int sectors) {
  io::TriangleMesh mesh;
  const auto count = static_cast<std::uint32_t>(profile.size()), around = static_cast<std::uint32_t>(sectors);
  for (const ProfilePoint& p : profile)
    for (std::uint32_t s = 0; s < around; ++s) {
      const double phi = 2 * pi * s / sectors;
      mesh.positions_m.push_back({p.r * std::cos(phi), p.r * std::sin(phi), p.z});
      mesh.normals.push_back({p.normal.x * std::cos(phi), p.normal.x * std::sin(phi), p.normal.y});
    }
  const auto low = static_cast<std::uint32_t>(mesh.positions_m.size()), high = low + 1;
  mesh.positions_m.push_back({0, 0, profile.front().z});
  mesh.normals.push_back({0, 0, -1});
  mesh.positions_m.push_back({0, 0, profile.back().z});
  mesh.normals.push_back({0, 0, 1});
  for (std::uint32_t s = 0; s < around; ++s) {
    const std::uint32_t t = (s + 1) % around;
    mesh.triangles.push_back({low, t, s});
    for (std::uint32_t ring = 0; ring + 1 < count; ++ring) {
      const std::uint32_t a = ring * around + s, b = ring * around + t, c = a + around, d = b + around;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
    mesh.triangles.push_back({high, (count - 1) * around + s, (count - 1) * around + t});
  }
  return mesh;
}

std::vector<ProfilePoint> profile_through(const std::vector<Vec2>& places) {
  std::vector<ProfilePoint> all;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Vec2 along = places[i + 1 < places.size() ? i + 1 : i] - places[i > 0 ? i - 1 : 0];
    const double length = norm(along);
    all.push_back({places[i].x, places[i].y, length > 0 ? Vec2{along.y / length, -along.x / length} : Vec2{1, 0}});
  }
  return all;
}

}  // namespace gonio::mesh
