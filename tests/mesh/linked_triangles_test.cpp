// Triangles that know their neighbours: after every collapse the links are those of the triangles that are left.
#include "mesh/clean/linked_triangles.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/error.h"
#include "base/random.h"
#include "mesh/shapes.h"

namespace gonio::mesh {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

Triangles left_of(const LinkedTriangles& links) {
  Triangles left;
  for (std::uint32_t t = 0; t < links.triangles(); ++t)
    if (!links.gone(t)) left.push_back({links.corner(t, 0), links.corner(t, 1), links.corner(t, 2)});
  return left;
}

// Built anew from what is left: the same neighbours round every vertex, borders where they were.
void expect_consistent(const LinkedTriangles& links, std::size_t vertices) {
  const LinkedTriangles anew(left_of(links), vertices);
  for (std::uint32_t v = 0; v < vertices; ++v) {
    ASSERT_EQ(links.isolated(v), anew.isolated(v)) << v;
    if (links.isolated(v)) continue;
    ASSERT_EQ(links.at_border(v), anew.at_border(v)) << v;
    const auto ring = [v](const LinkedTriangles& of) {
      std::vector<std::uint32_t> all;
      of.edges_from(v, [&](const LinkedTriangles::Edge& e) { return all.push_back(e.to), true; });
      std::sort(all.begin(), all.end());
      return all;
    };
    ASSERT_EQ(ring(links), ring(anew)) << v;
  }
}

void collapse_at_random(const io::TriangleMesh& mesh, std::uint64_t seed) {
  LinkedTriangles links(mesh.triangles, mesh.positions_m.size());
  Random random(seed);
  std::size_t left = links.triangles();
  for (int n = 0; n < 2000; ++n) {
    const auto v = static_cast<std::uint32_t>(random.uniform() * static_cast<double>(mesh.positions_m.size()));
    if (links.isolated(v)) continue;
    std::vector<LinkedTriangles::Edge> edges;
    links.edges_from(v, [&](const LinkedTriangles::Edge& e) { return edges.push_back(e), true; });
    const auto& edge = edges[static_cast<std::size_t>(random.uniform() * static_cast<double>(edges.size()))];
    if ((links.at_border(v) && !edge.border()) || !links.can_collapse(edge)) continue;
    left -= links.collapse(edge);
    if (n % 50 == 0) expect_consistent(links, mesh.positions_m.size());
  }
  EXPECT_EQ(left_of(links).size(), left);
  EXPECT_LT(left, mesh.triangles.size() / 2);
  expect_consistent(links, mesh.positions_m.size());
}

TEST(LinkedTriangles, StayASurfaceWhicheverEdgesCollapse) {
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    collapse_at_random(shapes::torus(2, 0.7, 24, 12), seed);
    collapse_at_random(shapes::ball(1, 3), seed);
    collapse_at_random(shapes::grid(14, 17, false, [](double u, double v) { return Vec3{u, v, 0}; }), seed);
  }
}

TEST(LinkedTriangles, RefuseWhatIsNoSurface) {
  EXPECT_THROW(LinkedTriangles({{0, 1, 2}, {0, 1, 3}}, 4), Error);             // an edge passed twice the same way
  EXPECT_THROW(LinkedTriangles({{0, 1, 1}}, 2), Error);                        // a corner twice
  EXPECT_THROW(LinkedTriangles({{0, 1, 7}}, 3), Error);                        // a corner that is none
  EXPECT_THROW(LinkedTriangles({{0, 1, 2}, {0, 3, 4}}, 5), Error);             // two fans at one corner
  EXPECT_THROW(LinkedTriangles({{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}, 5), Error);  // three at one edge
  EXPECT_NO_THROW(LinkedTriangles({{0, 1, 2}, {1, 0, 3}}, 5));
}

}  // namespace
}  // namespace gonio::mesh
