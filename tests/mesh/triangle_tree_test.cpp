// The tree against the search through every triangle.
#include "mesh/triangle_tree.h"

#include <gtest/gtest.h>

#include <set>

#include "mesh/inside.h"
#include "mesh/shapes.h"

namespace gonio::mesh {
namespace {

Vec3 anywhere(Random& random, double reach) {
  return {random.uniform(-reach, reach), random.uniform(-reach, reach), random.uniform(-reach, reach)};
}

TEST(TriangleTree, NearestPointsAreThoseOfTheSearchThroughAll) {
  const io::TriangleMesh raw = shapes::together(shapes::bumpy(1, 0.2, 3, 5), shapes::torus(2, 0.3, 30, 12));
  const Mesh all = prepare(raw, Shading::flat, "mesh.ply");
  const TriangleTree tree(raw.positions_m, raw.triangles);
  Random random(1);
  for (int i = 0; i < 500; ++i) {
    const Vec3 p = anywhere(random, 3);
    const auto found = tree.nearest(p);
    ASSERT_NEAR(found.distance_m, distance_m(all, p), 1e-12);
    ASSERT_NEAR(norm(p - found.at.point), found.distance_m, 1e-12);
    const auto& [a, b, c] = raw.triangles[found.triangle];
    const Vec3 again = raw.positions_m[a] * found.at.weights[0] + raw.positions_m[b] * found.at.weights[1] +
                       raw.positions_m[c] * found.at.weights[2];
    ASSERT_NEAR(norm(again - found.at.point), 0, 1e-12);
  }
}

TEST(TriangleTree, NothingWithinReachIsSaid) {
  const io::TriangleMesh raw = shapes::ball(1, 2);
  const TriangleTree tree(raw.positions_m, raw.triangles);
  EXPECT_TRUE(std::isinf(tree.nearest({3, 0, 0}, 1.9).distance_m));
  EXPECT_NEAR(tree.nearest({3, 0, 0}, 2.1).distance_m, 2, 1e-12);
}

TEST(TriangleTree, PointsNextToCollapsedTriangles) {
  const std::vector<Vec3> p{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  for (const std::array<std::uint32_t, 3> t :
       {std::array{0u, 1u, 2u}, std::array{0u, 0u, 2u}, std::array{2u, 0u, 0u}}) {
    const ClosestPoint at = closest_on_triangle({0.5, 1, 0}, p[t[0]], p[t[1]], p[t[2]]);
    EXPECT_NEAR(norm(at.point - Vec3{0.5, 0, 0}), 0, 1e-12);
  }
  EXPECT_EQ(closest_on_triangle({5, 1, 0}, p[1], p[1], p[1]).point, p[1]);
}

TEST(TriangleTree, FirstHitsAreThoseOfTheSearchThroughAll) {
  const io::TriangleMesh raw = shapes::bumpy(1, 0.3, 3, 9);
  const TriangleTree tree(raw.positions_m, raw.triangles);
  Random random(2);
  int hits = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 origin = anywhere(random, 2), direction = normalized(anywhere(random, 1));
    std::optional<double> first;
    for (std::uint32_t t = 0; t < raw.triangles.size(); ++t) {
      const std::vector<std::array<std::uint32_t, 3>> one{raw.triangles[t]};
      const auto hit = TriangleTree(raw.positions_m, one).first_hit(origin, direction, 0);
      if (hit && (!first || hit->t < *first)) first = hit->t;
    }
    const auto found = tree.first_hit(origin, direction, 0);
    ASSERT_EQ(found.has_value(), first.has_value());
    if (!found) continue;
    ++hits;
    ASSERT_DOUBLE_EQ(found->t, *first);
  }
  EXPECT_GT(hits, 30);
}

// Rays along the axes through vertices and edges: nothing slips through a closed surface.
TEST(TriangleTree, NoRayLeaksOutOfABox) {
  const io::TriangleMesh raw = shapes::box({1, 1, 1}, 4);
  const TriangleTree tree(raw.positions_m, raw.triangles);
  for (int i = 1; i < 4; ++i)
    for (int j = 1; j < 4; ++j)
      for (const Vec3 d : {Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, -1}, normalized(Vec3{1, 1, 0})})
        EXPECT_TRUE(tree.first_hit({i / 4.0, j / 4.0, 0.5}, d, 0)) << i << j;
}

TEST(TriangleTree, OverlappingBoxesAreAllVisitedOnce) {
  const io::TriangleMesh raw = shapes::ball(1, 3);
  const TriangleTree tree(raw.positions_m, raw.triangles);
  const auto box = [&](std::uint32_t t, int axis) {
    const auto& [a, b, c] = raw.triangles[t];
    return std::minmax({raw.positions_m[a][axis], raw.positions_m[b][axis], raw.positions_m[c][axis]});
  };
  std::multiset<std::pair<std::uint32_t, std::uint32_t>> found, expected;
  for (std::size_t leaf = 0; leaf < tree.leaves(); ++leaf)
    tree.overlapping_pairs(leaf, [&](std::uint32_t a, std::uint32_t b) { found.insert(std::minmax(a, b)); });
  for (std::uint32_t one = 0; one < raw.triangles.size(); ++one)
    for (std::uint32_t other = one + 1; other < raw.triangles.size(); ++other) {
      bool touch = true;
      for (int axis = 0; axis < 3; ++axis)
        touch &= box(one, axis).first <= box(other, axis).second && box(other, axis).first <= box(one, axis).second;
      if (touch) expected.insert({one, other});
    }
  EXPECT_EQ(found, expected);
}

// Halves of every size, down to none: all triangles are found from above themselves.
TEST(TriangleTree, IsWholeWhateverTheNumberOfTriangles) {
  const io::TriangleMesh raw = shapes::ball(1, 3);
  for (std::size_t n = 0; n <= 150; ++n) {
    const std::vector<std::array<std::uint32_t, 3>> some(raw.triangles.begin(),
                                                         raw.triangles.begin() + static_cast<std::ptrdiff_t>(n));
    const TriangleTree tree(raw.positions_m, some);
    for (std::uint32_t t = 0; t < n; ++t) {
      const auto& [a, b, c] = some[t];
      const Vec3 middle = (raw.positions_m[a] + raw.positions_m[b] + raw.positions_m[c]) / 3;
      const auto hit = tree.first_hit(middle * 2, middle * -1, 0);
      ASSERT_TRUE(hit) << n;
      ASSERT_EQ(hit->triangle, t) << n;
    }
  }
}

}  // namespace
}  // namespace gonio::mesh
