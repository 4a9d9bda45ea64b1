// Triangles of two meshes that meet, exactly.
#include <gtest/gtest.h>

#include "mesh/shapes.h"
#include "mesh/verdict.h"

namespace gonio::mesh {
namespace {

TEST(Intersections, OfTwoMeshesAreNamedByBoth) {
  const io::TriangleMesh one{.positions_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {5, 5, 5}, {6, 5, 5}, {5, 6, 5}},
                             .normals = {},
                             .texture = {},
                             .triangles = {{3, 4, 5}, {0, 1, 2}},
                             .properties = {},
                             .labels = {}};
  io::TriangleMesh other = one;
  other.triangles = {{0, 1, 2}};
  other.positions_m = {{0.2, 0.2, -1}, {0.2, 0.2, 1}, {2, 2, 0}};
  using Pairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  EXPECT_EQ(intersections(one, other), (Pairs{{1, 0}}));
  EXPECT_EQ(intersections(other, one), (Pairs{{0, 1}}));
  EXPECT_TRUE(self_intersections(other).empty());
}

TEST(Intersections, ATouchCountsAndTheNextDoubleDoesNot) {
  const io::TriangleMesh lower = shapes::box({1, 1, 1}, 2);
  EXPECT_FALSE(intersections(lower, shapes::moved(lower, {0.25, 0.25, 1})).empty());
  EXPECT_TRUE(intersections(lower, shapes::moved(lower, {0.25, 0.25, std::nextafter(1.0, 2.0)})).empty());
  EXPECT_TRUE(intersections(lower, shapes::moved(shapes::box({0.1, 0.1, 0.1}, 1), {0.4, 0.3, 0.3})).empty())
      << "one inside the other crosses nothing";
}

TEST(Intersections, StopWhereAsked) {
  const io::TriangleMesh ball = shapes::ball(1, 3), next = shapes::moved(ball, {0.5, 0.1, 0});
  EXPECT_GT(intersections(ball, next).size(), 20u);
  EXPECT_EQ(intersections(ball, next, 3).size(), 3u);
}

}  // namespace
}  // namespace gonio::mesh
