// Vertex normals by area and angle, and meshes that cannot be rendered.
#include "mesh/mesh.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "base/error.h"
#include "base/random.h"
#include "data.h"
#include "geom/rigid.h"

namespace gonio::mesh {
namespace {

using testing::HasSubstr;

io::TriangleMesh square() {
  io::TriangleMesh mesh;
  mesh.positions_m = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

std::string problem_of(const io::TriangleMesh& raw) {
  try {
    prepare(raw, Shading::smooth, "mesh.ply");
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), Exit::data);
    return error.what();
  }
  return "none";
}

TEST(Prepare, FlatSquare) {
  const Mesh mesh = prepare(square(), Shading::smooth, "mesh.ply");
  EXPECT_NEAR(area_m2(mesh), 1, 1e-15);
  for (const Vec3 n : mesh.normals) EXPECT_EQ(n, (Vec3{0, 0, 1}));
  EXPECT_TRUE(prepare(square(), Shading::flat, "mesh.ply").normals.empty());
}

TEST(Prepare, FileNormalsAreKeptAtUnitLength) {
  io::TriangleMesh raw = square();
  raw.normals = {{2, 0, 0}, {0, 3, 0}, {0, 0, 4}, {0, 0, 0}};
  const Mesh mesh = prepare(raw, Shading::smooth, "mesh.ply");
  EXPECT_EQ(mesh.normals[0], (Vec3{1, 0, 0}));
  EXPECT_EQ(mesh.normals[1], (Vec3{0, 1, 0}));
  EXPECT_EQ(mesh.normals[3], (Vec3{0, 0, 1}));  // none in the file: averaged
}

// A cube's corner touches one or two triangles of each face; only weights by angle make its normal the diagonal.
TEST(Normals, OfACubeDoNotDependOnItsDiagonals) {
  io::TriangleMesh cube;
  for (const double z : {0.0, 1.0})
    for (const double y : {0.0, 1.0})
      for (const double x : {0.0, 1.0}) cube.positions_m.push_back({x, y, z});
  cube.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  const auto normals = averaged_normals(cube.positions_m, cube.triangles);
  for (std::size_t v = 0; v < 8; ++v) {
    const Vec3 diagonal = normalized(cube.positions_m[v] - Vec3{0.5, 0.5, 0.5});
    // Area and angle: two half faces of 45 degrees weigh as much as one of 90 degrees.
    EXPECT_NEAR(dot(normals[v], diagonal), 1, 1e-12) << v;
  }
}

TEST(Normals, WeighAreas) {
  io::TriangleMesh mesh;  // a large horizontal and a small vertical triangle with equal angles at the shared vertex
  mesh.positions_m = {{0, 0, 0}, {3, 0, 0}, {0, 3, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 1, 2}, {0, 3, 4}};
  const Vec3 n = averaged_normals(mesh.positions_m, mesh.triangles)[0];
  EXPECT_NEAR(n.x / n.z, 1.0 / 9, 1e-12);
}

TEST(Normals, TurnWithTheMesh) {
  Random random(5);
  io::TriangleMesh mesh;
  for (int i = 0; i < 30; ++i) mesh.positions_m.push_back({random.uniform(), random.uniform(), random.uniform()});
  for (std::uint32_t i = 0; i < 60; ++i)
    mesh.triangles.push_back({random.below(30), random.below(30), random.below(30)});
  const Mat3 turn = matrix_of(quaternion_of_rotation_vector({0.3, -1.1, 0.7}));
  auto turned = mesh.positions_m;
  for (Vec3& p : turned) p = turn * p;
  const auto before = averaged_normals(mesh.positions_m, mesh.triangles),
             after = averaged_normals(turned, mesh.triangles);
  for (std::size_t v = 0; v < 30; ++v) EXPECT_NEAR(norm(turn * before[v] - after[v]), 0, 1e-9);
}

TEST(Prepare, LeavesOutTrianglesWithoutArea) {
  io::TriangleMesh raw = square();
  raw.triangles.push_back({1, 1, 2});
  raw.positions_m.push_back({2, 0, 0});
  raw.triangles.push_back({0, 1, 4});  // three on a line
  std::size_t dropped = 0;
  EXPECT_EQ(prepare(raw, Shading::smooth, "mesh.ply", &dropped).triangles.size(), 2u);
  EXPECT_EQ(dropped, 2u);
  raw.labels = {1, 2, 3, 4};
  std::swap(raw.triangles[0], raw.triangles[3]);
  EXPECT_EQ(prepare(raw, Shading::smooth, "mesh.ply").labels, (std::vector<std::int32_t>{2, 4}));
}

TEST(Prepare, RefusesInWords) {
  io::TriangleMesh bad = square();
  bad.positions_m[2].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(problem_of(bad), HasSubstr("mesh.ply: position of vertex 2 is not finite"));
  bad = square();
  bad.triangles[1][2] = 17;
  EXPECT_THAT(problem_of(bad), HasSubstr("triangle 1 names vertex 17 of 4"));
  bad = square();
  bad.triangles.clear();
  EXPECT_THAT(problem_of(bad), HasSubstr("no triangles"));
  bad.triangles = {{0, 0, 1}};
  EXPECT_THAT(problem_of(bad), HasSubstr("zero area"));
}

TEST(Prepare, TheStanfordBunny) {
  GONIO_NEEDS_DATA("recordings/bunny.ply");
  const Mesh bunny = prepare(io::read_ply(tests::data("recordings/bunny.ply")), Shading::smooth, "bunny.ply");
  EXPECT_EQ(bunny.triangles.size(), 69451u);
  for (const Vec3 n : bunny.normals) ASSERT_NEAR(norm(n), 1, 1e-12);
}

}  // namespace
}  // namespace gonio::mesh
