// See drawn_shapes.h.
#include "acquisition/plan/drawn_shapes.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <set>

namespace gonio::acquisition {
namespace {

void add_rod(io::TriangleMesh& to, Vec3 from, Vec3 end, double thickness_m) {
  if (!(norm(end - from) > 0)) return;
  const Basis across(normalized(end - from));
  const auto first = static_cast<std::uint32_t>(to.positions_m.size());
  for (const Vec3 middle : {from, end})
    for (int k = 0; k < 3; ++k) {
      const double a = 2 * pi * k / 3;
      to.positions_m.push_back(middle + (across.t * std::cos(a) + across.b * std::sin(a)) * (thickness_m / 2));
    }
  for (std::uint32_t k = 0; k < 3; ++k) {
    const std::uint32_t a = first + k, b = first + (k + 1) % 3;
    to.triangles.push_back({a, b, b + 3});
    to.triangles.push_back({a, b + 3, a + 3});
  }
  to.triangles.push_back({first, first + 2, first + 1});
  to.triangles.push_back({first + 3, first + 4, first + 5});
}

// Vertices in one of `cubes`^3 cubes become their mean; triangles with two corners in one cube vanish, and of those
// with the same corners one is left.
io::TriangleMesh gathered(const io::TriangleMesh& mesh, double cubes) {
  Vec3 low = mesh.positions_m.front(), high = low;
  for (const Vec3 p : mesh.positions_m) {
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  const double side = std::max(max_component(high - low), 1e-9) / cubes;
  std::map<std::array<int, 3>, std::uint32_t> place_of;
  std::vector<std::uint32_t> goes_to;
  std::vector<double> weight;
  io::TriangleMesh out;
  for (const Vec3 p : mesh.positions_m) {
    const Vec3 at = (p - low) / side;
    const std::array cube{static_cast<int>(at.x), static_cast<int>(at.y), static_cast<int>(at.z)};
    const auto [found, is_new] = place_of.try_emplace(cube, static_cast<std::uint32_t>(out.positions_m.size()));
    if (is_new) out.positions_m.push_back({}), weight.push_back(0);
    out.positions_m[found->second] += p, weight[found->second] += 1;
    goes_to.push_back(found->second);
  }
  for (std::size_t i = 0; i < weight.size(); ++i) out.positions_m[i] = out.positions_m[i] / weight[i];
  std::set<std::array<std::uint32_t, 3>> known;
  for (const auto& t : mesh.triangles) {
    const std::array<std::uint32_t, 3> corners{goes_to[t[0]], goes_to[t[1]], goes_to[t[2]]};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
    auto sorted = corners;
    std::ranges::sort(sorted);
    if (known.insert(sorted).second) out.triangles.push_back(corners);
  }
  return out;
}

}  // namespace

io::TriangleMesh drawn_solid(const Solid& solid, std::size_t most) {
  SolidMesh whole = mesh_of(solid);
  io::TriangleMesh drawn;
  drawn.positions_m = std::move(whole.vertices_m), drawn.triangles = std::move(whole.triangles);
  for (double cubes = 96; drawn.triangles.size() > most && cubes > 2; cubes /= 1.4) drawn = gathered(drawn, cubes);
  return drawn;
}

io::TriangleMesh ball_mesh(double radius_m) {
  Solid ball;
  ball.shape = Solid::Shape::ball;
  ball.sides_m.x = radius_m;
  return drawn_solid(ball);
}

io::TriangleMesh pyramid_frame(const std::vector<Vec3>& corners, double thickness_m) {
  io::TriangleMesh mesh;
  for (std::size_t k = 0; k < corners.size(); ++k) {
    add_rod(mesh, {}, corners[k], thickness_m);
    add_rod(mesh, corners[k], corners[(k + 1) % corners.size()], thickness_m);
  }
  return mesh;
}

io::TriangleMesh pyramid(const std::vector<Vec3>& corners) {
  io::TriangleMesh mesh;
  mesh.positions_m = corners;
  mesh.positions_m.push_back({});
  const auto count = static_cast<std::uint32_t>(corners.size());
  for (std::uint32_t k = 0; k < count; ++k) mesh.triangles.push_back({count, (k + 1) % count, k});
  for (std::uint32_t k = 1; k + 1 < count; ++k) mesh.triangles.push_back({0, k, k + 1});
  return mesh;
}

io::TriangleMesh double_pyramid(double r) {
  io::TriangleMesh mesh;
  mesh.positions_m = {{r, 0, 0}, {0, r, 0}, {-r, 0, 0}, {0, -r, 0}, {0, 0, r}, {0, 0, -r}};
  for (std::uint32_t k = 0; k < 4; ++k) {
    mesh.triangles.push_back({k, (k + 1) % 4, 4});
    mesh.triangles.push_back({(k + 1) % 4, k, 5});
  }
  return mesh;
}

io::TriangleMesh dial(double radius_m, double thickness_m) {
  constexpr int pieces = 32;
  io::TriangleMesh mesh;
  const auto at = [radius_m](int k) {
    const double a = 2 * pi * k / pieces;
    return Vec3{radius_m * std::cos(a), radius_m * std::sin(a), 0};
  };
  for (int k = 0; k < pieces; ++k) add_rod(mesh, at(k), at(k + 1), thickness_m);
  add_rod(mesh, {}, at(0), thickness_m);
  return mesh;
}

}  // namespace gonio::acquisition
