// Our cleaning: what it takes off, what it must leave, and that it beats the others.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "base/error.h"
#include "base/parallel.h"
#include "mesh/clean.h"
#include "mesh/clean/local_quadratic.h"
#include "mesh/shapes.h"
#include "mesh/verdict.h"

namespace gonio::mesh {
namespace {

constexpr double voxel = 0.05;  // edges of ball(1, 5) are about as long

double rms_angle_to_radius(const io::TriangleMesh& mesh) {
  const auto normals = mesh.normals.empty() ? averaged_normals(mesh.positions_m, mesh.triangles) : mesh.normals;
  double sum = 0;
  for (std::size_t v = 0; v < normals.size(); ++v)
    sum += std::pow(norm(cross(normals[v], normalized(mesh.positions_m[v]))), 2);
  return std::sqrt(sum / normals.size());
}

double mean_radius(const io::TriangleMesh& mesh) {
  double sum = 0;
  for (const Vec3 p : mesh.positions_m) sum += norm(p) / mesh.positions_m.size();
  return sum;
}

TEST(LocalQuadratic, FindsAQuadraticAndItsCovariance) {
  LocalQuadratic quadratic;
  Random random(1);
  for (int i = 0; i < 40; ++i) {
    const double u = random.uniform(-2, 2), v = random.uniform(-2, 2);
    quadratic.add(u, v, 1 + 2 * u - v + 0.5 * u * u + 0.25 * u * v - v * v, random.uniform(0.5, 2));
  }
  const auto fit = quadratic.fit();
  ASSERT_TRUE(fit.good);
  EXPECT_NEAR(fit.residual, 0, 1e-9);
  const LocalQuadratic::Terms expected{1, 2, -1, 0.5, 0.25, -1};
  for (std::size_t i = 0; i < 6; ++i) EXPECT_NEAR(fit.c[i], expected[i], 1e-10);
  EXPECT_NEAR(fit.at(1, 1), 1.75, 1e-10);
}

// The stated variance of the slope is that of 400 repeats: chi square with 400 degrees of freedom lies within 4 sd.
TEST(LocalQuadratic, StatesTheVarianceOfItsSlope) {
  double sum = 0, stated = 0;
  for (int repeat = 0; repeat < 400; ++repeat) {
    LocalQuadratic quadratic;
    Random places(3), noise(4, repeat);
    for (int i = 0; i < 30; ++i) {
      const double u = places.uniform(-2, 2), v = places.uniform(-2, 2);
      quadratic.add(u, v, 0.1 * noise.normal());
    }
    const auto fit = quadratic.fit();
    sum += fit.c[1] * fit.c[1];
    stated = 0.01 * fit.variance_of_slope(0);
  }
  EXPECT_NEAR(sum / 400, stated, 4 * stated * std::sqrt(2.0 / 400));
}

TEST(LocalQuadratic, PointsOnOneLineAreNoSurface) {
  LocalQuadratic line;
  for (int i = 0; i < 20; ++i) line.add(i * 0.1, i * 0.2, 1);
  EXPECT_FALSE(line.fit().good);
}

TEST(CleanWithin, ABallsNormalsAreTenTimesBetterAndItsRadiusStays) {
  const io::TriangleMesh raw = shapes::noisy(shapes::ball(1, 5), 0.05 * voxel, 3);
  io::TriangleMesh mesh = raw;
  const BoundedResult result = clean_within(mesh, {.within_m = 0.5 * voxel});
  EXPECT_NEAR(result.sigma_m, 0.05 * voxel, 0.008 * voxel);
  EXPECT_NEAR(result.inflation, 1, 0.3);
  EXPECT_LT(rms_angle_to_radius(mesh), 0.12 * rms_angle_to_radius(raw));
  EXPECT_NEAR(mean_radius(mesh), mean_radius(raw), 0.02 * voxel);
  EXPECT_LT(result.normal_noise_after_rad, 0.25 * result.normal_noise_before_rad);
  EXPECT_THAT(self_intersections(mesh), testing::IsEmpty());
}

// Errors that are means over discs four edges wide look like shape to narrow fits: taken for independent ones they are
// thought small, and wider fits seem to contradict.
TEST(CleanWithin, ErrorsThatNeighboursShareAreNotTakenForShape) {
  const io::TriangleMesh ball = shapes::ball(1, 5);
  const std::vector<Vec3>& at = ball.positions_m;
  const double disc = 2 * voxel, nearest = 1 - disc * disc / 2;
  Random random(9);
  std::vector<double> own(at.size()), radius(at.size(), 1);
  for (double& e : own) e = 0.5 * voxel * random.normal();
  double squares = 0;
  for (std::size_t v = 0; v < at.size(); ++v) {
    double sum = 0, count = 0;
    for (std::size_t w = 0; w < at.size(); ++w)
      if (dot(at[v], at[w]) > nearest) sum += own[w], ++count;
    radius[v] += sum / count, squares += std::pow(sum / count, 2);
  }
  const double sigma = std::sqrt(squares / static_cast<double>(at.size()));
  io::TriangleMesh mesh = ball;
  for (std::size_t v = 0; v < at.size(); ++v) mesh.positions_m[v] = at[v] * radius[v];
  io::TriangleMesh blind = mesh;
  const std::vector<double> stated(at.size(), sigma);
  const BoundedResult as_shared = clean_within(mesh, {.within_m = voxel, .sigma_m = stated, .alike_m = 2 * disc});
  const BoundedResult as_own = clean_within(blind, {.within_m = voxel});
  EXPECT_GT(as_shared.mean_radius_m, 1.2 * as_own.mean_radius_m);
  EXPECT_LT(as_own.sigma_m, 0.9 * sigma) << "what is shared goes into the fits";
  EXPECT_LT(rms_angle_to_radius(mesh), 0.67 * rms_angle_to_radius(blind));
}

TEST(CleanWithin, TheBoundHolds) {
  for (const double within : {0.0, 0.02, 0.06}) {
    const io::TriangleMesh raw = shapes::noisy(shapes::torus(1, 0.4, 90, 40), 0.1 * voxel, 5);
    io::TriangleMesh mesh = raw;
    const BoundedResult result = clean_within(mesh, {.within_m = within * voxel});
    double largest = 0;
    for (std::size_t v = 0; v < raw.positions_m.size(); ++v)
      largest = std::max(largest, norm(mesh.positions_m[v] - raw.positions_m[v]));
    EXPECT_LE(largest, within * voxel);
    EXPECT_EQ(largest, result.largest_move_m);
    if (within > 0) {
      EXPECT_GT(result.at_bound, raw.positions_m.size() / 10);
    }
  }
}

TEST(CleanWithin, EdgesStaySharpAndFacesBecomeFlat) {
  const io::TriangleMesh truth = shapes::box({1, 1, 1}, 20);
  io::TriangleMesh mesh = shapes::noisy(truth, 0.05 * voxel, 7);
  const BoundedResult result = clean_within(mesh, {.within_m = 0.5 * voxel});
  EXPECT_GT(result.sharp_edges, 12u * 20 * 9 / 10);
  double flat = 0, edges = 0, n_flat = 0, n_edges = 0;
  for (std::size_t v = 0; v < mesh.positions_m.size(); ++v) {
    const Vec3 a = truth.positions_m[v], move = mesh.positions_m[v] - a;
    int sides = 0;
    double square = 0;
    for (int axis = 0; axis < 3; ++axis)
      if (a[axis] == 0 || a[axis] == 1) {
        ++sides;
        square += move[axis] * move[axis];
      }
    (sides == 1 ? flat : edges) += square;
    (sides == 1 ? n_flat : n_edges) += sides;
  }
  EXPECT_LT(std::sqrt(flat / n_flat), 0.025 * voxel);
  EXPECT_LT(std::sqrt(edges / n_edges), 0.05 * voxel) << "a rounded edge would be off by 0.3 voxels";
}

TEST(CleanWithin, WhatIsCleanStays) {
  const io::TriangleMesh truth = shapes::bumpy(1, 0.2, 5, 4);
  io::TriangleMesh mesh = truth;
  clean_within(mesh, {.within_m = voxel});
  EXPECT_LT(distance(mesh, truth, 3000, 1).rms_m, 0.01 * voxel);
}

// Beside each other at equal face counts; the truth is the ball itself.
TEST(CleanWithin, LightThroughABallIsBentLessWronglyThanByTheOthers) {
  io::TriangleMesh truth = shapes::ball(1, 5);
  const io::TriangleMesh raw = shapes::noisy(truth, 0.05 * voxel, 11);
  truth.normals = truth.positions_m;
  io::TriangleMesh loop = raw, taubin = raw, ours = raw;
  clean_by_subdivision(loop, {.first = 0.25});
  smooth_taubin(taubin);
  clean_within(ours, {.within_m = 0.5 * voxel});
  decimate(taubin, loop.triangles.size());
  decimate(ours, loop.triangles.size());
  const auto bent = [&](const io::TriangleMesh& mesh) { return ray_bend(mesh, truth, 1.5, 2000, 1).median_rad; };
  EXPECT_LT(bent(ours), 0.5 * bent(loop));
  EXPECT_LT(bent(ours), 0.5 * bent(taubin));
}

TEST(CleanWithin, DoesNotDependOnThreads) {
  io::TriangleMesh one = shapes::noisy(shapes::ball(1, 4), 0.005, 2), all = one;
  set_threads(1);
  clean_within(one, {.within_m = 0.02});
  set_threads(0);
  clean_within(all, {.within_m = 0.02});
  EXPECT_EQ(one.positions_m, all.positions_m);
}

// Vertices that the data know ten times worse pull less.
TEST(CleanWithin, UncertainVerticesPullLess) {
  const io::TriangleMesh truth = shapes::ball(1, 5);
  io::TriangleMesh mesh = shapes::noisy(truth, 0.01 * voxel, 2);
  std::vector<double> sigma(mesh.positions_m.size(), 0.01 * voxel);
  Random random(1);
  for (std::size_t v = 0; v < sigma.size(); v += 5) {
    sigma[v] = 0.2 * voxel;
    mesh.positions_m[v] *= 1 + 0.2 * voxel * random.normal();
  }
  io::TriangleMesh blind = mesh;
  clean_within(mesh, {.within_m = voxel, .sigma_m = sigma});
  clean_within(blind, {.within_m = voxel});
  EXPECT_LT(distance(mesh, truth, 3000, 1).rms_m, 0.6 * distance(blind, truth, 3000, 1).rms_m);
  sigma.pop_back();
  EXPECT_THROW(clean_within(mesh, {.within_m = voxel, .sigma_m = sigma}), Error);
}

TEST(NormalNoise, FollowsTheNoiseAndPassesOverEdges) {
  const io::TriangleMesh box = shapes::box({1, 1, 1}, 16);
  EXPECT_LT(normal_noise_rad(box), 1e-6);
  const double small = normal_noise_rad(shapes::noisy(shapes::ball(1, 5), 0.02 * voxel, 1));
  const double large = normal_noise_rad(shapes::noisy(shapes::ball(1, 5), 0.04 * voxel, 1));
  EXPECT_NEAR(large / small, 2, 0.1);
}

}  // namespace
}  // namespace gonio::mesh
