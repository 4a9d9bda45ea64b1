#include "glass/body.h"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "base/error.h"
#include "base/hash.h"
#include "data.h"
#include "glass/glasses.h"
#include "glass/implicit.h"
#include "glass/object.h"
#include "io/encode_ply.h"
#include "mesh/inside.h"
#include "mesh/mesh.h"
#include "mesh/topology.h"
#include "mesh/verdict.h"

namespace gonio::glass {
namespace {

// Eight bodies of every family: sound by the exact predicates that drawn_body() asks, of unit size, on the plane; the
// same numbers give the same body, others another one.
TEST(Bodies, OfEveryFamilyAreSoundAndTheSameEachTime) {
  EXPECT_GE(all_forms().size(), 5u);
  for (const Form* form : all_forms()) {
    std::set<std::string> seen;
    for (std::uint64_t number = 0; number < 8; ++number) {
      const CheckedBody checked = drawn_body(*form, 3, number);
      const io::TriangleMesh& mesh = checked.body.mesh;
      EXPECT_LE(mesh.triangles.size(), most_triangles);
      double low = 1e9, high = 0;
      for (const Vec3& p : mesh.positions_m) low = std::min(low, p.z), high = std::max(high, p.z);
      EXPECT_NEAR(low, 0, 1e-12) << form->id();
      EXPECT_LE(high, 1 + 1e-9) << form->id();
      EXPECT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.positions_m.size());
      seen.insert(sha256(io::encode_ply(mesh)));
      EXPECT_EQ(io::encode_ply(mesh), io::encode_ply(drawn_body(*form, 3, number).body.mesh)) << form->id();
    }
    EXPECT_EQ(seen.size(), 8u) << form->id();
  }
}

// Vertex normals look to the side that the triangles look to, and by no more away from it than a facet's curvature.
TEST(Bodies, NormalsLookOutOfTheGlass) {
  for (const Form* form : all_forms()) {
    const io::TriangleMesh mesh = drawn_body(*form, 5, 1).body.mesh;
    if (mesh.normals.empty()) continue;
    std::size_t wrong = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
      const Vec3 n = cross(mesh.positions_m[b] - mesh.positions_m[a], mesh.positions_m[c] - mesh.positions_m[a]);
      wrong += dot(n, mesh.normals[a] + mesh.normals[b] + mesh.normals[c]) > 0 ? 0 : 1;
    }
    EXPECT_LE(wrong, mesh.triangles.size() / 500) << form->id();
  }
}

TEST(Bodies, HaveManyGenera) {
  std::set<std::int64_t> genera;
  for (std::uint64_t number = 0; number < 10; ++number)
    for (const char* form : {"blend", "solid"}) genera.insert(drawn_body(*find_form(form), 11, number).genus);
  EXPECT_GE(genera.size(), 4u);
  EXPECT_GE(*genera.rbegin(), 3);
}

// A vessel's wall is as thick as it says, measured by distances; a hollow body has two surfaces, its inner one within.
TEST(Bodies, WallsAreAsThickAsStated) {
  for (std::uint64_t number = 0; number < 4; ++number) {
    const CheckedBody bottle = drawn_body(*find_form("bottle"), 2, number);
    EXPECT_GT(bottle.body.wall_low, 0.003);
    EXPECT_GT(bottle.body.wall_high, bottle.body.wall_low);
    const CheckedBody blown = drawn_body(*find_form("blown"), 2, number);
    EXPECT_EQ(blown.components, 2u);
    EXPECT_GT(blown.body.wall_high / blown.body.wall_low, 1.2);
    const auto mesh = mesh::prepare(blown.body.mesh, mesh::Shading::flat, "blown");
    const Vec3 middle = [&] {
      Vec3 sum{};
      for (const Vec3& p : mesh.positions_m) sum += p;
      return sum / static_cast<double>(mesh.positions_m.size());
    }();
    EXPECT_NEAR(mesh::winding_number(mesh, middle), 0, 1e-6);  // hollow
  }
}

// What stands in a vessel overlaps its wall and nothing beyond it: no point of it lies outside of the vessel's hull.
TEST(Bodies, FillingsStayWithinTheWall) {
  for (std::uint64_t number = 0; number < 6; ++number) {
    const CheckedBody bottle = drawn_body(*find_form("bottle"), 4, number);
    ASSERT_TRUE(bottle.body.filling);
    const auto wall = mesh::prepare(bottle.body.mesh, mesh::Shading::flat, "bottle");
    std::size_t in_the_wall = 0, rim = 0;
    for (std::size_t i = 0; i < bottle.body.filling->positions_m.size(); i += 97) {
      const Vec3& p = bottle.body.filling->positions_m[i];
      in_the_wall += mesh::winding_number(wall, p) > 0.5 ? 1 : 0, ++rim;
    }
    EXPECT_GT(in_the_wall, rim / 2);
  }
}

TEST(Bodies, FilesThatBoundNothingAreRefused) {
  const tests::ScratchFolder folder;
  const auto path = folder / "open.ply";
  io::TriangleMesh open;
  open.positions_m = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  open.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}};
  io::write_ply(path, open);
  EXPECT_THROW(body_in(path), Error);
  open.triangles.push_back({0, 3, 2});
  io::write_ply(path, open);
  EXPECT_EQ(body_in(path).genus, 0);
  for (auto& [a, b, c] : open.triangles) std::swap(b, c);
  io::write_ply(path, open);
  EXPECT_THROW(body_in(path), Error);  // inside out
}

// Distances of the primitives are those of their surfaces: no farther than the place moves, and right on the axis.
TEST(Implicit, DistancesAreDistances) {
  EXPECT_NEAR(distance_to_box({0.5, 0, 0}, {0.2, 0.3, 0.4}, 0.01), 0.3, 1e-12);
  EXPECT_NEAR(distance_to_torus({0.3, 0, 0}, {0, 0, 1}, 0.2, 0.05), 0.05, 1e-12);
  EXPECT_NEAR(distance_to_capsule({0, 0.3, 0.5}, {0, 0, 0}, {0, 0, 1}, 0.1), 0.2, 1e-12);
  EXPECT_NEAR(distance_to_cylinder({0, 0, 0.5}, {0, 0, 1}, 0.1, 0.2), 0.3, 1e-12);
  EXPECT_NEAR(blended(0.1, 0.9, 0.2), 0.1, 1e-12);
  EXPECT_NEAR(blended(0.1, 0.1, 0.2), 0.05, 1e-12);
}

// A ball of radius 0.3: volume to 1 %, normals radial.
TEST(Implicit, ABallIsFound) {
  const io::TriangleMesh ball = body_of([](Vec3 p) { return 0.3 - norm(p); }, 0.5, 48, 20000, true);
  EXPECT_NEAR(mesh::topology_of(mesh::prepare(ball, mesh::Shading::smooth, "ball")).volume_m3, 4 * pi / 3 * 0.027,
              1e-3);
  for (std::size_t i = 0; i < ball.positions_m.size(); ++i)
    EXPECT_GT(dot(ball.normals[i], normalized(ball.positions_m[i])), 0.999);
  EXPECT_THROW(body_of([](Vec3 p) { return 0.6 - norm(p); }, 0.5, 16, 100, true), Error);
  EXPECT_THROW(body_of([](Vec3 p) { return -1 - norm(p); }, 0.5, 16, 100, true), Error);
}

// Indices at the d line and Abbe numbers as the catalogues print them.
TEST(Glasses, HaveTheirCataloguesIndices) {
  const auto abbe = [](const Glass& g) { return (g.index(0.58756) - 1) / (g.index(0.48613) - g.index(0.65627)); };
  EXPECT_NEAR(find_glass("bk7")->index(0.58756), 1.51680, 1e-5);
  EXPECT_NEAR(abbe(*find_glass("bk7")), 64.17, 0.01);
  EXPECT_NEAR(find_glass("flint")->index(0.58756), 1.62005, 2e-5);  // N-F2's melt: 1.62005
  EXPECT_NEAR(abbe(*find_glass("flint")), 36.4, 0.1);
  EXPECT_NEAR(find_glass("silica")->index(0.58756), 1.45846, 1e-5);
  EXPECT_NEAR(find_glass("soda-lime")->index(0.58756), 1.5234, 1e-3);
  EXPECT_NEAR(find_glass("water")->index(0.5893), 1.3330, 5e-4);
  EXPECT_EQ(find_glass("ice"), nullptr);
}

}  // namespace
}  // namespace gonio::glass
