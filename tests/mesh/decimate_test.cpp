// Decimation, subdivision and the smoothing of others: what must stay, and what must come out.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "mesh/clean.h"
#include "mesh/shapes.h"
#include "mesh/verdict.h"

namespace gonio::mesh {
namespace {

TEST(Decimate, FiftyClosedShapesStayClosedAndManifoldAndKeepTheirGenus) {
  std::size_t intersections = 0;
  for (std::uint64_t seed = 0; seed < 50; ++seed) {
    Random random(seed);
    io::TriangleMesh mesh = seed % 3 == 0   ? shapes::torus(2, random.uniform(0.3, 1.2), 40, 24)
                            : seed % 3 == 1 ? shapes::bumpy(1, 0.5, 4, seed)
                                            : shapes::box({1, random.uniform(0.1, 2), 1}, 10);
    mesh = shapes::noisy(std::move(mesh), random.uniform(0, 0.01), seed);
    const Soundness before = soundness(mesh);
    const auto wanted = static_cast<std::size_t>(random.uniform(0.02, 0.5) * mesh.triangles.size());
    const std::size_t left = decimate(mesh, wanted);
    EXPECT_EQ(left, mesh.triangles.size());
    EXPECT_LE(left, wanted + 1);
    const Soundness after = soundness(mesh);
    ASSERT_TRUE(after.closed() && after.manifold()) << seed;
    EXPECT_EQ(after.genus_sum, before.genus_sum) << seed;
    EXPECT_EQ(after.components, before.components) << seed;
    EXPECT_EQ(after.unused_vertices, 0u);
    EXPECT_GT(shapes::volume_of(mesh), 0);
    intersections += self_intersections(mesh).size();
  }
  EXPECT_EQ(intersections, 0u);
}

TEST(Decimate, PlanesAndEdgesOfABoxCostNothing) {
  io::TriangleMesh mesh = shapes::box({1, 2, 3}, 12);
  EXPECT_LE(decimate(mesh, 12), 12u);
  EXPECT_NEAR(shapes::volume_of(mesh), 6, 1e-9);
  EXPECT_LT(distance(shapes::box({1, 2, 3}, 4), mesh, 1000, 1).largest_m, 1e-9);
}

TEST(Decimate, WhatStaysKeepsWhatItHas) {
  io::TriangleMesh mesh = shapes::ball(1, 4);
  for (const Vec3 p : mesh.positions_m) {
    mesh.normals.push_back(p);
    mesh.texture.push_back({p.x, p.y});
  }
  mesh.properties.resize(1);
  for (const Vec3 p : mesh.positions_m) mesh.properties[0].push_back(static_cast<float>(p.z));
  for (const auto& t : mesh.triangles) mesh.labels.push_back(mesh.positions_m[t[0]].z + mesh.positions_m[t[1]].z > 0);
  decimate(mesh, 300);
  ASSERT_EQ(mesh.normals.size(), mesh.positions_m.size());
  ASSERT_EQ(mesh.labels.size(), mesh.triangles.size());
  for (std::size_t v = 0; v < mesh.positions_m.size(); ++v) {
    EXPECT_EQ(mesh.normals[v], mesh.positions_m[v]);
    EXPECT_EQ(mesh.texture[v].y, mesh.positions_m[v].y);
    EXPECT_EQ(mesh.properties[0][v], static_cast<float>(mesh.positions_m[v].z));
  }
}

TEST(Decimate, ABallStaysABall) {
  io::TriangleMesh mesh = shapes::ball(1, 6);
  decimate(mesh, 1000);
  EXPECT_LT(distance(mesh, shapes::ball(1, 6), 5000, 1).rms_m, 0.01);
}

TEST(Decimate, NothingBelowATetrahedronAndNoCollapseOfWhatIsThere) {
  io::TriangleMesh mesh = shapes::ball(1, 3);
  EXPECT_GE(decimate(mesh, 0), 4u);
  EXPECT_TRUE(soundness(mesh).closed());
  io::TriangleMesh small = shapes::ball(1, 0);
  EXPECT_EQ(decimate(small, 100), 8u);
}

TEST(Decimate, WhatIsNoSurfaceIsRefused) {
  io::TriangleMesh fin = shapes::ball(1, 2);
  fin.positions_m.push_back({3, 0, 0});
  fin.triangles.push_back(
      {fin.triangles[0][0], fin.triangles[0][1], static_cast<std::uint32_t>(fin.positions_m.size() - 1)});
  EXPECT_THROW(decimate(fin, 10), Error);
}

TEST(Sqrt3, TriplesFacesAndStaysClosed) {
  for (std::uint64_t seed = 0; seed < 5; ++seed) {
    io::TriangleMesh mesh = shapes::bumpy(1, 0.4, 3, seed);
    const std::size_t before = mesh.triangles.size();
    subdivide_sqrt3(mesh);
    EXPECT_EQ(mesh.triangles.size(), 3 * before);
    const Soundness sound = soundness(mesh);
    EXPECT_TRUE(sound.closed() && sound.manifold());
    EXPECT_EQ(sound.euler, 2);
    EXPECT_GT(shapes::volume_of(mesh), 0);
  }
}

// Its limit surface is smooth: normals of neighbouring faces approach each other, and the radius stays within what the
// scheme takes off a coarse ball.
TEST(Sqrt3, OfABallBecomesSmooth) {
  io::TriangleMesh mesh = shapes::ball(1, 2);
  double widest = 0, before = 0;
  for (int round = 0; round < 4; ++round) {
    subdivide_sqrt3(mesh);
    before = widest;
    widest = 0;
    const auto normals = averaged_normals(mesh.positions_m, mesh.triangles);
    for (const auto& t : mesh.triangles)
      for (int c = 0; c < 3; ++c) widest = std::max(widest, norm(normals[t[c]] - normals[t[(c + 1) % 3]]));
    if (round > 0) {
      EXPECT_LT(widest, 0.75 * before);
    }
  }
  for (const Vec3 p : mesh.positions_m) ASSERT_NEAR(norm(p), 0.96, 0.04);
}

TEST(Taubin, KeepsTheVolumeAndTakesNoise) {
  const io::TriangleMesh truth = shapes::ball(1, 5);
  io::TriangleMesh mesh = shapes::noisy(truth, 0.005, 1);
  const double before = distance(mesh, truth, 4000, 1).rms_m;
  smooth_taubin(mesh);
  EXPECT_NEAR(shapes::volume_of(mesh), shapes::volume_of(truth), 0.01 * shapes::volume_of(truth));
  EXPECT_LT(distance(mesh, truth, 4000, 1).rms_m, 0.6 * before);
  EXPECT_THROW(smooth_taubin(mesh, 5, 0.5, -0.4), Error);
}

TEST(Taubin, BordersStayWhereTheyRun) {
  io::TriangleMesh sheet = shapes::grid(12, 12, false, [](double u, double v) { return Vec3{u, v, 0}; });
  smooth_taubin(sheet, 50);
  for (const Vec3 p : sheet.positions_m) {
    EXPECT_EQ(p.z, 0);
    EXPECT_GE(std::min({p.x, p.y, 1 - p.x, 1 - p.y}), -0.1);
  }
}

TEST(SubdivisionLoop, EndsWithAShareOfTheFacesAndASmoothBall) {
  const io::TriangleMesh truth = shapes::ball(1, 6);
  io::TriangleMesh mesh = shapes::noisy(truth, 0.003, 2);
  clean_by_subdivision(mesh, {.first = 0.05});
  EXPECT_NEAR(mesh.triangles.size(), 0.05 * truth.triangles.size() * std::pow(0.99, 4), 0.01 * truth.triangles.size());
  const Soundness sound = soundness(mesh);
  EXPECT_TRUE(sound.closed() && sound.manifold());
  EXPECT_LT(distance(mesh, truth, 2000, 1).rms_m, 0.02);
}

}  // namespace
}  // namespace gonio::mesh
