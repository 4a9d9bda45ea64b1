// Points of one camera's pixels become a surface, and steps do not.
#include "mesh/pixel_neighbours.h"

#include <gtest/gtest.h>

namespace gonio::mesh {
namespace {

TEST(PixelNeighbours, AreJoinedWhereTheSurfaceIs) {
  std::vector<Vec3> points;
  std::vector<Vec2> pixels;
  for (int y = 0; y < 6; ++y)
    for (int x = 0; x < 8; ++x) {
      if (x == 6 && y == 2) continue;  // not told
      const double nearer = x < 4 ? 0 : 0.02;
      points.push_back({0.001 * x, 0.001 * y, 0.5 - nearer}), pixels.push_back({double(x), double(y)});
    }
  points.push_back({0, 0, 0.4}), pixels.push_back({2.5, 3});  // between pixels
  const io::TriangleMesh mesh = joined_neighbours(points, pixels);
  // 3 x 5 whole cells on either side, of which four touch the hole: one triangle is left of each.
  EXPECT_EQ(mesh.triangles.size(), 2u * 30 - 4);
  EXPECT_EQ(mesh.positions_m.size(), 47u);
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.positions_m[t[0]], b = mesh.positions_m[t[1]], c = mesh.positions_m[t[2]];
    EXPECT_LT(cross(b - a, c - a).z, 0);  // fronts look at the camera
    EXPECT_EQ(a.z, b.z);
    EXPECT_EQ(b.z, c.z);
  }
  EXPECT_TRUE(joined_neighbours(points, std::vector<Vec2>(points.size(), Vec2{0.5, 0.5})).triangles.empty());
}

}  // namespace
}  // namespace gonio::mesh
