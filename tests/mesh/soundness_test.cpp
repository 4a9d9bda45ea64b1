// Soundness and self-intersections of meshes that were built to have them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "mesh/shapes.h"
#include "mesh/verdict.h"

namespace gonio::mesh {
namespace {

using Pair = std::pair<std::uint32_t, std::uint32_t>;

TEST(Soundness, OfClosedSurfacesOfKnownGenus) {
  const Soundness ball = soundness(shapes::ball(1, 3));
  EXPECT_TRUE(ball.closed() && ball.manifold());
  EXPECT_EQ(ball.components, 1u);
  EXPECT_EQ(ball.euler, 2);
  EXPECT_EQ(ball.genus_sum, 0);
  const Soundness both = soundness(shapes::together(shapes::torus(2, 0.5, 20, 10), shapes::ball(0.5, 2)));
  EXPECT_EQ(both.components, 2u);
  EXPECT_EQ(both.euler, 2);
  EXPECT_EQ(both.genus_sum, 1);
}

TEST(Soundness, VerticesAtOnePlaceCountAsOne) {
  io::TriangleMesh split = shapes::box({1, 1, 1}, 2), seams;
  for (const auto& t : split.triangles) {
    const auto first = static_cast<std::uint32_t>(seams.positions_m.size());
    for (const std::uint32_t v : t) seams.positions_m.push_back(split.positions_m[v]);
    seams.triangles.push_back({first, first + 1, first + 2});
  }
  const Soundness sound = soundness(seams);
  EXPECT_TRUE(sound.closed() && sound.manifold());
  EXPECT_EQ(sound.euler, 2);
  EXPECT_THAT(self_intersections(seams), testing::IsEmpty());
}

TEST(Soundness, HolesDisagreementsAndFins) {
  io::TriangleMesh open = shapes::ball(1, 2);
  open.triangles.pop_back();
  EXPECT_EQ(soundness(open).boundary_edges, 3u);
  EXPECT_EQ(soundness(open).genus_sum, 0);
  io::TriangleMesh turned = shapes::ball(1, 2);
  std::swap(turned.triangles[7][0], turned.triangles[7][1]);
  EXPECT_EQ(soundness(turned).disagreeing_edges, 3u);
  EXPECT_FALSE(soundness(turned).closed());
  io::TriangleMesh fin = shapes::ball(1, 2);
  fin.positions_m.push_back({3, 0, 0});
  fin.positions_m.push_back({4, 0, 0});
  fin.triangles.push_back(
      {fin.triangles[0][0], fin.triangles[0][1], static_cast<std::uint32_t>(fin.positions_m.size() - 2)});
  const Soundness sound = soundness(fin);
  EXPECT_EQ(sound.crowded_edges, 1u);
  EXPECT_EQ(sound.boundary_edges, 2u);
  EXPECT_EQ(sound.unused_vertices, 1u);
  EXPECT_FALSE(sound.manifold());
}

// Two balls that share one vertex: every edge is fine, the vertex is not.
TEST(Soundness, APinchedVertex) {
  const io::TriangleMesh a = shapes::ball(1, 2);
  const io::TriangleMesh both = shapes::together(a, shapes::moved(a, {2, 0, 0}));
  const Soundness sound = soundness(both);
  EXPECT_TRUE(sound.closed());
  EXPECT_EQ(sound.crowded_edges, 0u);
  EXPECT_EQ(sound.pinched_vertices, 1u);
  EXPECT_EQ(sound.components, 1u);
  EXPECT_FALSE(sound.manifold());
}

TEST(Soundness, DegenerateTriangles) {
  io::TriangleMesh mesh = shapes::ball(1, 1);
  const std::uint32_t v = mesh.triangles[0][0], w = mesh.triangles[0][1];
  mesh.triangles.push_back({v, v, w});
  EXPECT_EQ(soundness(mesh).degenerate_triangles, 1u);
  EXPECT_TRUE(soundness(mesh).closed());
}

TEST(SelfIntersections, CleanMeshesHaveNone) {
  for (std::uint64_t seed = 0; seed < 5; ++seed)
    EXPECT_THAT(self_intersections(shapes::bumpy(1, 0.3, 4, seed)), testing::IsEmpty());
  EXPECT_THAT(self_intersections(shapes::torus(2, 0.5, 40, 20)), testing::IsEmpty());
  EXPECT_THAT(self_intersections(shapes::box({1, 2, 3}, 6)), testing::IsEmpty());
}

// Triangle 1 is put through triangle 0 in every way in which two triangles can meet.
TEST(SelfIntersections, EveryWayToMeet) {
  const auto pair = [](std::vector<Vec3> p, std::array<std::uint32_t, 3> a, std::array<std::uint32_t, 3> b) {
    io::TriangleMesh mesh;
    mesh.positions_m = std::move(p);
    mesh.triangles = {a, b};
    return self_intersections(mesh).size();
  };
  const Vec3 o{0, 0, 0}, x{4, 0, 0}, y{0, 4, 0};
  EXPECT_EQ(pair({o, x, y, {1, 1, -1}, {1, 1, 1}, {5, 5, 1}}, {0, 1, 2}, {3, 4, 5}), 1u) << "through";
  EXPECT_EQ(pair({o, x, y, {1, 1, 0}, {1, 1, 1}, {5, 5, 1}}, {0, 1, 2}, {3, 4, 5}), 1u) << "a corner touches";
  EXPECT_EQ(pair({o, x, y, {1, 1, 1e-300}, {1, 1, 1}, {5, 5, 1}}, {0, 1, 2}, {3, 4, 5}), 0u) << "a hair above";
  EXPECT_EQ(pair({o, x, y, {1, 1, 0}, {9, 1, 0}, {1, 9, 0}}, {0, 1, 2}, {3, 4, 5}), 1u) << "in one plane";
  EXPECT_EQ(pair({o, x, y, {3, 3, 0}, {9, 3, 0}, {3, 9, 0}}, {0, 1, 2}, {3, 4, 5}), 0u) << "in one plane, apart";
  EXPECT_EQ(pair({o, x, y, {1, 1, 1}, {2, 2, -1}}, {0, 1, 2}, {0, 3, 4}), 1u) << "share a corner";
  EXPECT_EQ(pair({o, x, y, {-1, 1, 1}, {-2, 2, -1}}, {0, 1, 2}, {0, 3, 4}), 0u) << "share a corner alone";
  EXPECT_EQ(pair({o, x, y, {1, 1, 0}}, {0, 1, 2}, {0, 1, 3}), 1u) << "folded over an edge";
  EXPECT_EQ(pair({o, x, y, {1, 1, 1e-300}}, {0, 1, 2}, {0, 1, 3}), 0u) << "nearly folded";
  EXPECT_EQ(pair({o, x, y, {1, -1, 0}}, {0, 1, 2}, {1, 0, 3}), 0u) << "unfolded";
  EXPECT_EQ(pair({o, x, y}, {0, 1, 2}, {1, 2, 0}), 1u) << "twice the same";
}

TEST(SelfIntersections, TwoBallsThatOverlapMeetInARing) {
  const io::TriangleMesh both = shapes::together(shapes::ball(1, 3), shapes::moved(shapes::ball(1, 3), {1, 0.1, 0.2}));
  const auto found = self_intersections(both, 100000);
  EXPECT_GT(found.size(), 50u);
  for (const auto& [a, b] : found) {
    EXPECT_LT(a, 512u);
    EXPECT_GE(b, 512u);
  }
  EXPECT_TRUE(std::is_sorted(found.begin(), found.end()));
  const auto some = self_intersections(both, 7);
  EXPECT_EQ(some, std::vector<Pair>(found.begin(), found.begin() + 7));
}

// A vertex pushed through the far side: found where it is, and nowhere else.
TEST(SelfIntersections, ASpikeThroughTheOppositeWall) {
  io::TriangleMesh mesh = shapes::ball(1, 3);
  mesh.positions_m[0] = {-1.3, 0.013, 0.007};
  const auto found = self_intersections(mesh);
  ASSERT_FALSE(found.empty());
  for (const auto& [a, b] : found) {
    const auto holds = [&](std::uint32_t t) {
      return mesh.triangles[t][0] == 0 || mesh.triangles[t][1] == 0 || mesh.triangles[t][2] == 0;
    };
    EXPECT_TRUE(holds(a) || holds(b));
  }
}

}  // namespace
}  // namespace gonio::mesh
