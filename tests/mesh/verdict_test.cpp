// Distances and the bending of rays where the answer is known.
#include "mesh/verdict.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/parallel.h"
#include "mesh/shapes.h"

namespace gonio::mesh {
namespace {

TEST(Distance, BetweenConcentricBalls) {
  const io::TriangleMesh inner = shapes::ball(1, 5), outer = shapes::ball(1.1, 5);
  const Distance out = distance(outer, inner, 20000, 1), in = distance(inner, outer, 20000, 1);
  // Faces of this ball lie up to 4e-4 below the sphere.
  EXPECT_NEAR(out.rms_m, 0.1, 4e-4);
  EXPECT_NEAR(out.mean_m, 0.1, 4e-4);
  EXPECT_NEAR(out.largest_m, 0.1, 6e-4);
  EXPECT_NEAR(out.mean_signed_m, 0.1, 4e-4);
  EXPECT_NEAR(in.mean_signed_m, -0.1, 4e-4);
  EXPECT_EQ(out.samples, 20000u);
}

TEST(Distance, OfAMeshToItselfIsZero) {
  const io::TriangleMesh mesh = shapes::bumpy(1, 0.3, 4, 3);
  EXPECT_LT(distance(mesh, mesh, 5000, 2).largest_m, 1e-14);
}

// One way a spike is far from the box, the other way nearly nothing is far from it.
TEST(Distance, IsNotSymmetric) {
  io::TriangleMesh spiked = shapes::box({1, 1, 1}, 8);
  const io::TriangleMesh box = spiked;
  for (Vec3& p : spiked.positions_m)
    if (p == Vec3{0.5, 0.5, 1}) p = {0.5, 0.5, 2};
  EXPECT_NEAR(distance(spiked, box, 1000, 3).largest_m, 1, 1e-12) << "the vertex counts though no sample meets it";
  EXPECT_LT(distance(box, spiked, 1000, 3).largest_m, 0.13);
}

// Half of the faces moved out by 1: rms sqrt(1/2), mean 1/2, 99th percentile 1.
TEST(Distance, StatisticsAreByArea) {
  const auto sheet = [](double z) {
    return shapes::grid(4, 4, false, [z](double u, double v) { return Vec3{u, v, z}; });
  };
  io::TriangleMesh both = shapes::together(sheet(0), sheet(1));
  both.triangles.push_back({0, 0, 1});
  const Distance d = distance(both, sheet(0), 10000, 5);
  EXPECT_NEAR(d.rms_m, std::sqrt(0.5), 1e-3);
  EXPECT_NEAR(d.mean_m, 0.5, 1e-3);
  EXPECT_EQ(d.p99_m, 1);
}

// Points off the edge of a sharp wedge: the nearer face alone would tell the wrong side.
TEST(Distance, TheSideIsRightBesideSharpEdges) {
  const io::TriangleMesh wedge = shapes::box({1, 0.02, 1}, 3);
  Random random(4);
  io::TriangleMesh probes;
  for (int i = 0; i < 300; ++i) {
    const Vec3 p{random.uniform(-0.5, 1.5), random.uniform(-0.5, 0.5), random.uniform(-0.5, 1.5)};
    const bool inside = p.x > 0 && p.x < 1 && p.y > 0 && p.y < 0.02 && p.z > 0 && p.z < 1;
    if (inside) continue;
    const double h = 1e-6;
    probes.positions_m = {p, p + Vec3{h, 0, 0}, p + Vec3{0, h, 0}};
    probes.triangles = {{0, 1, 2}};
    ASSERT_GT(distance(probes, wedge, 4, 1).mean_signed_m, 0) << p.x << " " << p.y << " " << p.z;
  }
}

TEST(Distance, DoesNotDependOnThreads) {
  const io::TriangleMesh a = shapes::bumpy(1, 0.3, 3, 3), b = shapes::ball(1, 3);
  set_threads(1);
  const Distance one = distance(a, b, 3000, 7);
  set_threads(0);
  const Distance all = distance(a, b, 3000, 7);
  EXPECT_EQ(one.rms_m, all.rms_m);
  EXPECT_EQ(one.p99_m, all.p99_m);
  EXPECT_THROW(distance(io::TriangleMesh{}, b, 10, 1), Error);
}

io::TriangleMesh with_radial_normals(io::TriangleMesh ball) {
  for (const Vec3 p : ball.positions_m) ball.normals.push_back(normalized(p));
  return ball;
}

TEST(RayBend, OfAMeshAgainstItselfIsZero) {
  const RayBend bend = ray_bend(shapes::bumpy(1, 0.3, 4, 1), shapes::bumpy(1, 0.3, 4, 1), 1.5, 2000, 1);
  EXPECT_EQ(bend.rms_rad, 0);
  EXPECT_EQ(bend.differing_paths, 0u);
  EXPECT_GT(bend.rays, 1500u);
}

// Through a plane-parallel plate a ray goes on as it came, however thick it is: all but those by the narrow sides.
TEST(RayBend, OfAPlateIsZeroWhateverItsThickness) {
  const RayBend bend =
      ray_bend(shapes::moved(shapes::faceted(shapes::box({10, 10, 0.13}, 3)), {-5, -5, 0}),
               shapes::moved(shapes::faceted(shapes::box({10, 10, 0.1}, 5)), {-5, -5, 0.01}), 1.5, 4000, 2);
  EXPECT_LT(bend.median_rad, 1e-12);
  EXPECT_LT(bend.p95_rad, 1e-12);
  EXPECT_LT(bend.differing_paths, 4000 * 0.08);
}

// A ray at distance b = R sin i from the centre of a ball is turned by 2 (i - t), sin t = sin i / eta. In a ball that
// is larger by the share d it is turned by 2 d (tan i - tan t) less; of isotropic rays half pass within sin i =
// sqrt(1/2).
TEST(RayBend, OfABallAsSnellSays) {
  const double share = 0.01;
  const auto large = with_radial_normals(shapes::ball(1 + share, 6)), ball = with_radial_normals(shapes::ball(1, 6));
  const RayBend bend = ray_bend(large, ball, 1.5, 20000, 3);
  const double t = std::asin(std::sqrt(0.5) / 1.5);
  EXPECT_NEAR(bend.median_rad, 2 * share * (1 - std::tan(t)), 0.03 * share);
  EXPECT_LT(bend.differing_paths, 20000 * 0.001);
}

TEST(RayBend, IsDeterministicAndSeeded) {
  const auto a = shapes::noisy(shapes::ball(1, 4), 0.002, 1), b = shapes::ball(1, 4);
  set_threads(1);
  const double one = ray_bend(a, b, 1.5, 1000, 9).rms_rad;
  set_threads(0);
  EXPECT_EQ(ray_bend(a, b, 1.5, 1000, 9).rms_rad, one);
  EXPECT_NE(ray_bend(a, b, 1.5, 1000, 10).rms_rad, one);
}

// A wall through which light goes once and one through which it goes twice.
TEST(RayBend, RaysOnOtherPathsAreCounted) {
  const auto hollow = shapes::together(shapes::ball(1, 4), shapes::inside_out(shapes::ball(0.8, 4)));
  const RayBend bend = ray_bend(shapes::ball(1, 4), hollow, 1.2, 2000, 4);
  // Rays within eta * 0.8 of the centre reach the cavity: a share (0.8 * ...)^2 of all; total reflection takes the
  // rest.
  EXPECT_GT(bend.differing_paths, 2000 * 0.6);
  EXPECT_LT(bend.differing_paths, 2000 * 0.99);
}

// Rays straight through a plate: each of two crossings turns them by (eta - 1) tilt near normal incidence, more when
// oblique; and twice the noise bends twice as much.
TEST(RayBend, OfNoise) {
  const auto plate = shapes::faceted(shapes::box({10, 10, 0.1}, 3));
  const RayBend none = ray_bend_of_noise(plate, 0, 1.5, 2000, 5);
  const RayBend small = ray_bend_of_noise(plate, 0.001, 1.5, 4000, 5);
  const RayBend twice = ray_bend_of_noise(plate, 0.002, 1.5, 4000, 5);
  EXPECT_LT(none.rms_rad, 1e-7);
  EXPECT_GT(small.median_rad, 0.5 * 0.001 * std::sqrt(2) * 0.8);
  EXPECT_LT(small.median_rad, 0.5 * 0.001 * std::sqrt(2) * 3);
  EXPECT_NEAR(twice.median_rad / small.median_rad, 2, 0.02);
}

}  // namespace
}  // namespace gonio::mesh
