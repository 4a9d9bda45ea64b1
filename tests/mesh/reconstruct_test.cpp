// Meshes from points whose surface and errors are known.
#include "mesh/reconstruct.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "base/parallel.h"
#include "mesh/reconstruct/point_tree.h"
#include "mesh/reconstruct/poisson_disk.h"
#include "mesh/seen_world.h"
#include "mesh/shapes.h"
#include "mesh/verdict.h"

namespace gonio::mesh {
namespace {

using gonio::tests::see;
using gonio::tests::SeenFrom;

constexpr double radius_m = 0.05;

// A ball from the eight corners of a cube about it.
MeasuredPoints ball_points(std::uint64_t seed) {
  static const io::TriangleMesh truth = shapes::ball(radius_m, 5);
  static const TriangleTree tree(truth.positions_m, truth.triangles);
  MeasuredPoints points;
  for (int k = 0; k < 8; ++k)
    see(tree, truth,
        {.camera = Vec3{k & 1 ? 0.35 : -0.35, k & 2 ? 0.35 : -0.35, k & 4 ? 0.35 : -0.35},
         .target = {},
         .width = 80,
         .height = 80,
         .f_px = 360},
        seed, points);
  return points;
}

// Two sheets of 10 cm, one `gap_m` before the other, seen from before; the front one is half as wide.
MeasuredPoints sheet_points(double gap_m) {
  io::TriangleMesh truth;
  for (int k = 0; k < 2; ++k) {
    const double half = k == 0 ? 0.025 : 0.05, z = k == 0 ? gap_m : 0;
    const auto first = static_cast<std::uint32_t>(truth.positions_m.size());
    for (const Vec3 p : {Vec3{-half, -0.05, z}, Vec3{half, -0.05, z}, Vec3{half, 0.05, z}, Vec3{-half, 0.05, z}})
      truth.positions_m.push_back(p);
    truth.triangles.push_back({first, first + 1, first + 2});
    truth.triangles.push_back({first, first + 2, first + 3});
  }
  const TriangleTree tree(truth.positions_m, truth.triangles);
  MeasuredPoints points;
  for (const double x : {-0.2, 0.0, 0.2})
    see(tree, truth,
        {.camera = {x, 0.02, 0.4}, .target = {}, .width = 160, .height = 160, .f_px = 500, .sigma_px = 0.05}, 3,
        points);
  return points;
}

double largest_difference(const io::TriangleMesh& a, const io::TriangleMesh& b) {
  double most = 0;
  for (std::size_t v = 0; v < a.positions_m.size(); ++v)
    most = std::max(most, norm(a.positions_m[v] - b.positions_m[v]));
  return most;
}

TEST(PointTree, FindsWhatAskingEveryPointFinds) {
  Random random(5);
  std::vector<Vec3> points;
  for (int i = 0; i < 3000; ++i)
    points.push_back({random.uniform(), 0.1 * random.uniform(), i % 7 == 0 ? 0.5 : random.uniform()});
  points.push_back(points[17]);
  const PointTree tree(points);
  std::vector<PointTree::Neighbour> near, all;
  for (int k = 0; k < 50; ++k) {
    const Vec3 at = k == 0 ? points[17] : Vec3{random.uniform(), random.uniform(), random.uniform()};
    all.clear();
    for (std::uint32_t i = 0; i < points.size(); ++i) all.push_back({dot(points[i] - at, points[i] - at), i});
    std::ranges::sort(all);
    tree.nearest(at, 20, near);
    ASSERT_EQ(near.size(), 20U);
    for (std::size_t i = 0; i < near.size(); ++i) EXPECT_EQ(near[i].point, all[i].point);
    std::size_t within = 0, expected = 0;
    tree.within(at, 0.2, [&](std::uint32_t) { ++within; });
    for (const PointTree::Neighbour& n : all) expected += n.squared <= 0.04;
    EXPECT_EQ(within, expected);
  }
}

TEST(PoissonDisk, LeavesPointsApartAndNoGaps) {
  Random random(2);
  std::vector<Vec3> points;
  for (int i = 0; i < 20000; ++i) points.push_back({random.uniform(), random.uniform(), 0});
  const PointTree tree(points);
  const std::vector<std::uint32_t> kept = poisson_disk(tree, 1000, 1);
  EXPECT_NEAR(static_cast<double>(kept.size()), 1000, 25);
  std::vector<Vec3> places;
  for (const std::uint32_t i : kept) places.push_back(points[i]);
  const PointTree samples(places);
  double least = 1, most = 0;
  std::vector<PointTree::Neighbour> near;
  for (const Vec3 p : places) samples.nearest(p, 2, near), least = std::min(least, std::sqrt(near[1].squared));
  for (const Vec3 p : points) samples.nearest(p, 1, near), most = std::max(most, std::sqrt(near[0].squared));
  EXPECT_GT(least, 0.02);
  EXPECT_LE(most, least);  // every point that went was too near to one that stayed
  EXPECT_EQ(poisson_disk(tree, 1000, 1), kept);
  EXPECT_NE(poisson_disk(tree, 1000, 2), kept);
  EXPECT_EQ(poisson_disk(tree, 20000, 1).size(), points.size());
}

class Ball : public testing::Test {
 protected:
  static const Reconstruction& made() {
    static const Reconstruction once = reconstruct(ball_points(1), {.depth = 7});
    return once;
  }
};

TEST_F(Ball, IsClosedInOnePieceAndFacesOutwards) {
  const Soundness sound = soundness(made().mesh);
  EXPECT_EQ(sound.components, 1U);
  EXPECT_EQ(sound.genus_sum, 0);
  EXPECT_TRUE(sound.closed());
  EXPECT_TRUE(sound.manifold());
  ASSERT_EQ(made().components.size(), 1U);
  EXPECT_NEAR(made().components[0].area_m2, 4 * pi * radius_m * radius_m, 2e-4);
  const auto& p = made().mesh.positions_m;
  double turned = 0, inwards = 0;
  for (std::size_t v = 0; v < p.size(); ++v) {
    const double cosine = dot(made().mesh.normals[v], normalized(p[v]));
    EXPECT_GT(cosine, 0.5);
    turned += 2 - 2 * cosine;
  }
  EXPECT_LT(std::sqrt(turned / static_cast<double>(p.size())), 0.12);
  for (const auto& [a, b, c] : made().mesh.triangles) {  // slivers may be turned over by the noise of their corners
    const Vec3 doubled = cross(p[b] - p[a], p[c] - p[a]);
    if (dot(doubled, p[a]) < 0) inwards += 0.5 * norm(doubled);
  }
  EXPECT_LT(inwards, 1e-3 * made().components[0].area_m2);
}

TEST_F(Ball, IsAsFarFromTheTruthAsItStates) {
  double squares = 0, stated = 0;
  for (std::size_t v = 0; v < made().sigma_m.size(); ++v) {
    const double off = norm(made().mesh.positions_m[v]) - radius_m;
    squares += off * off, stated += double{made().sigma_m[v]} * double{made().sigma_m[v]};
  }
  EXPECT_NEAR(std::sqrt(squares / stated), 1, 0.2);
  EXPECT_NEAR(made().deviation.whitened, 1, 0.08);  // points take part in what they are held against
  EXPECT_NEAR(made().noise_ratio, 1, 0.05);
  EXPECT_LT(made().deviation.bare, made().deviation.points / 100);
}

TEST_F(Ball, DoesNotDependOnThreads) {
  set_threads(1);
  const Reconstruction one = reconstruct(ball_points(1), {.depth = 7});
  set_threads(0);
  ASSERT_EQ(one.mesh.positions_m.size(), made().mesh.positions_m.size());
  EXPECT_EQ(one.mesh.triangles, made().mesh.triangles);
  EXPECT_EQ(largest_difference(one.mesh, made().mesh), 0);
  EXPECT_EQ(one.sigma_m, made().sigma_m);
}

TEST_F(Ball, CarriesColours) {
  MeasuredPoints points = ball_points(1);
  for (const Vec3 p : points.positions_m) points.colour.push_back({p.x > 0 ? 1.0f : 0.0f, 0.25f, 0});
  const Reconstruction coloured = reconstruct(points, {.depth = 6});
  ASSERT_EQ(coloured.colour.size(), coloured.mesh.positions_m.size());
  for (std::size_t v = 0; v < coloured.colour.size(); ++v) {
    const double x = coloured.mesh.positions_m[v].x;
    if (std::abs(x) > 0.005) {
      EXPECT_NEAR(coloured.colour[v][0], x > 0 ? 1 : 0, 1e-6);
    }
    EXPECT_NEAR(coloured.colour[v][1], 0.25, 1e-6);
  }
}

TEST_F(Ball, ErrorsThatAreLargerThanStatedAreSeen) {
  MeasuredPoints points = ball_points(1);
  for (auto& c : points.covariance_m2)
    for (double& v : c) v /= 16;
  const Reconstruction bold = reconstruct(points, {.depth = 7});
  EXPECT_NEAR(bold.noise_ratio, 4, 0.4);
  EXPECT_NEAR(bold.deviation.whitened, 4, 0.4);
}

class Sheets : public testing::TestWithParam<double> {};

// The front one, and what it leaves to be seen of the other on either side; a rim may turn off by a vertex or two.
TEST_P(Sheets, AreNotBridged) {
  const Reconstruction made = reconstruct(sheet_points(GetParam()), {.depth = 8});
  ASSERT_EQ(made.components.size(), 3U);
  EXPECT_NEAR(made.components[0].area_m2, 0.005, 2e-4);
  std::size_t between = 0;
  for (const Vec3 p : made.mesh.positions_m)
    between += std::min(std::abs(p.z), std::abs(p.z - GetParam())) > 0.4 * GetParam();
  EXPECT_LT(between, made.mesh.positions_m.size() / 1000);
}
INSTANTIATE_TEST_SUITE_P(Gaps, Sheets, testing::Values(0.003, 0.01));

TEST(Reconstruct, PointsOnALineMakeNoSurface) {
  MeasuredPoints points;
  points.viewpoints_m = {{{0, 0, 1}}};
  for (int i = 0; i < 200; ++i) {
    points.positions_m.push_back({0.001 * i, 0, 0});
    points.covariance_m2.push_back({1e-8, 0, 0, 1e-8, 0, 1e-8});
    points.view.push_back(0);
  }
  EXPECT_TRUE(reconstruct(points, {.depth = 5}).mesh.triangles.empty());
}

}  // namespace
}  // namespace gonio::mesh
