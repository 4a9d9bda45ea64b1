// Markers in phantoms whose spheres are known: none missed, none invented, centres within their covariance.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "base/error.h"
#include "base/random.h"
#include "stats/distributions.h"
#include "volume/markers.h"
#include "volume/phantoms.h"

namespace gonio::volume {
namespace {

using testing::HasSubstr;

struct Ball {
  Vec3 centre{};
  double radius = 0, value = 1;
};
constexpr double blur = 0.8, air = 0.1;

// Balls side by side; where two overlap the first has the place.
io::VolumeData balls(std::array<std::size_t, 3> size, const std::vector<Ball>& all, double noise, std::uint64_t seed,
                     Vec3 scale = {1, 1, 1}) {
  return phantom::sampled(
      size,
      [&](Vec3 p) {
        double v = air, left = 1;
        for (const Ball& b : all) {
          if (norm(p - b.centre) > b.radius + 8 * blur) continue;
          const double share = left * phantom::ball(p, b.centre, b.radius, blur);
          v += share * (b.value - air), left -= share;
        }
        return v;
      },
      noise, 0.3, seed, scale);
}
Markers found_in(const io::VolumeData& data, const MarkerWish& wish, double threshold = 0.55) {
  return markers(*phantom::in_memory(data), phantom::rough_surface(data, threshold), threshold, wish);
}
void tell(const Markers& m) {
  for (const Marker& f : m.found)
    std::printf("  found %.3f %.3f %.3f r %.3f +- %.3f cover %.2f rms %.3f value %.3f\n", f.centre.x, f.centre.y, f.centre.z,
                f.radius, f.sigma_radius, f.cover, f.rms_residual, f.mean_value);
  for (const RefusedMarker& f : m.refused)
    std::printf("  refused %.2f %.2f %.2f r %.2f: %s\n", f.centre.x, f.centre.y, f.centre.z, f.radius, f.why.c_str());
}
// x' C^-1 x
double mahalanobis(Vec3 x, const std::array<double, 9>& c) {
  const auto minor = [&](int a, int b, int d, int e) { return c[a] * c[e] - c[b] * c[d]; };
  const double determinant = c[0] * minor(4, 5, 7, 8) - c[1] * minor(3, 5, 6, 8) + c[2] * minor(3, 4, 6, 7);
  const Mat3 inverse{{minor(4, 5, 7, 8), c[2] * c[7] - c[1] * c[8], minor(1, 2, 4, 5), minor(5, 3, 8, 6),
                      c[0] * c[8] - c[2] * c[6], c[2] * c[3] - c[0] * c[5], minor(3, 4, 6, 7), c[1] * c[6] - c[0] * c[7],
                      minor(0, 1, 3, 4)}};
  return dot(x, inverse * x) / determinant;
}

TEST(Markers, OneBallInAirIsFoundWhereItIs) {
  const Ball one{{15.3, 16.1, 14.8}, 6};
  const Markers m = found_in(balls({32, 32, 32}, {one}, 0.05, 3), {});
  tell(m);
  ASSERT_EQ(m.found.size(), 1u);
  EXPECT_LT(norm(m.found[0].centre - one.centre), 0.05);
  EXPECT_NEAR(m.found[0].radius, 6, 0.05);
  EXPECT_GT(m.found[0].cover, 0.95);
  EXPECT_NEAR(m.found[0].mean_value, 1, 0.03);
  EXPECT_TRUE(m.refused.empty());
}

// Markers of plastic round a bowl of glass: glued with a missing cap, touching one another, cut by the border.
struct Scene {
  std::vector<Ball> bodies{};
  std::vector<Ball> markers{};
};
Scene glass_with(std::uint64_t seed, std::size_t count, double smallest, double largest) {
  Random random(seed, 5);
  const Vec3 middle{38 + random.uniform(-1, 1), 38 + random.uniform(-1, 1), 37 + random.uniform(-1, 1)};
  Scene scene;
  const double radius = random.uniform(15, 18);
  while (scene.markers.size() < count) {
    const double z = random.uniform(-1, 1), phi = random.uniform(0, 2 * pi), s = std::sqrt(1 - z * z);
    const Vec3 d{s * std::cos(phi), s * std::sin(phi), z};
    const double r = random.uniform(smallest, largest);
    const Ball ball{middle + d * (radius + r - random.uniform(0, 0.3 * r)), r};
    bool free = true;
    for (const Ball& b : scene.markers) free = free && norm(b.centre - ball.centre) > b.radius + r + 0.2;
    if (free) scene.markers.push_back(ball);
  }
  scene.bodies = {{middle, radius - 3.5, air}, {middle, radius, 2.2}};
  return scene;
}

TEST(Markers, GluedOnesAreFoundAndTheGlassIsNoMarker) {
  int missed = 0, invented = 0, within = 0, all = 0;
  double worst = 0, squares = 0;
  const int scenes = std::getenv("GONIO_WHOLE") ? std::atoi(std::getenv("GONIO_WHOLE")) : 4;
  for (int n = 0; n < scenes; ++n) {
    const Scene scene = glass_with(100 + n, 3 + n % 7, 3, 8);
    std::vector<Ball> bodies = scene.bodies;
    bodies.insert(bodies.end(), scene.markers.begin(), scene.markers.end());
    const Markers m = found_in(balls({76, 76, 76}, bodies, 0.05, 900 + n), {});
    std::vector<bool> met(m.found.size());
    for (const Ball& b : scene.markers) {
      bool hit = false;
      for (std::size_t f = 0; f < m.found.size(); ++f) {
        const Vec3 off = m.found[f].centre - b.centre;
        if (norm(off) > 1) continue;
        hit = met[f] = true;
        worst = std::max(worst, norm(off));
        squares += dot(off, off) / 3;
        all += 1;
        within += mahalanobis(off, m.found[f].covariance) < stats::chi2_quantile(0.95, 3) ? 1 : 0;
        if (norm(off) > 0.05)
          std::printf("  scene %d: marker r %.2f off by %.3f (%+.3f %+.3f %+.3f) chi2 %.1f cover %.2f radius off %+.3f\n", n, b.radius, norm(off),
                      off.x, off.y, off.z, mahalanobis(off, m.found[f].covariance), m.found[f].cover, m.found[f].radius - b.radius);
      }
      missed += hit ? 0 : 1;
      if (!hit) std::printf("  scene %d: missed %.2f %.2f %.2f r %.2f\n", n, b.centre.x, b.centre.y, b.centre.z, b.radius), tell(m);
    }
    for (std::size_t f = 0; f < met.size(); ++f)
      if (!met[f]) ++invented, std::printf("  scene %d: invented\n", n), tell(m);
  }
  std::printf("%d scenes, %d markers: missed %d invented %d, coverage %.3f, rms per axis %.4f, worst %.4f\n", scenes, all, missed,
              invented, within / double(all), std::sqrt(squares / all), worst);
  EXPECT_EQ(missed, 0);
  EXPECT_EQ(invented, 0);
}

TEST(Markers, AKnobOfTheObjectsOwnIsRefused) {
  Scene scene = glass_with(7, 4, 5, 5);
  const Vec3 middle = scene.bodies[1].centre;
  std::vector<Ball> bodies = scene.bodies;
  bodies.insert(bodies.end(), scene.markers.begin(), scene.markers.end());
  // A knob half out of the glass, where no marker is.
  for (const Vec3 d : {Vec3{1, 0, 0}, Vec3{-1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{0, 0, 1}, Vec3{0, 0, -1}}) {
    const Ball knob{middle + d * (scene.bodies[1].radius + 3), 5, 2.2};
    bool free = true;
    for (const Ball& b : scene.markers) free = free && norm(b.centre - knob.centre) > 12;
    if (!free) continue;
    bodies.push_back(knob);
    break;
  }
  ASSERT_EQ(bodies.size(), 7u);
  const Markers m = found_in(balls({76, 76, 76}, bodies, 0.05, 4), {});
  tell(m);
  EXPECT_EQ(m.found.size(), 4u);
  EXPECT_THAT(m.refused, testing::Contains(testing::Field(&RefusedMarker::why, HasSubstr("part of the object"))));
}

TEST(Markers, HollowSpheresBubblesAndTubesAreRefusedInWords) {
  // A hollow ball (first the void), a solid one with a bubble, and a rod.
  const auto data = phantom::sampled({80, 44, 44}, [&](Vec3 p) {
    const phantom::Disc rod(4, blur);
    return air + 0.9 * (phantom::ball(p, {20, 21, 22}, 11, blur) - phantom::ball(p, {20, 21, 22}, 8, blur)) +
           0.9 * (phantom::ball(p, {56, 21, 22}, 15, blur) - phantom::ball(p, {57, 20, 23}, 5, blur));
  }, 0.04, 0.3, 5);
  MarkerWish wish;
  wish.largest = 13;
  const Markers m = found_in(data, wish);
  tell(m);
  EXPECT_TRUE(m.found.empty());
  EXPECT_THAT(m.refused, testing::Contains(testing::Field(&RefusedMarker::why, HasSubstr("hollow"))));
  EXPECT_THAT(m.refused, testing::Contains(testing::Field(&RefusedMarker::why, HasSubstr("bubble"))));
}

TEST(Markers, TwoThatTouchAndOneThatTheBorderCutsAreAllFound) {
  const std::vector<Ball> all{{{14, 20, 20}, 6}, {{26, 20, 20}, 6}, {{22.4, 36.2, 21.1}, 6}, {{38.2, 14.5, 9.7}, 6}};
  const Markers m = found_in(balls({42, 40, 40}, all, 0.05, 8), {});
  tell(m);
  ASSERT_EQ(m.found.size(), 4u);
  for (const Ball& b : all) {
    double least = 99;
    for (const Marker& f : m.found) least = std::min(least, norm(f.centre - b.centre));
    EXPECT_LT(least, 0.08) << b.centre.x;
  }
}

TEST(Markers, AKnownRadiusNarrowsAndIsHeld) {
  const std::vector<Ball> all{{{14, 14, 14}, 5}, {{34, 14, 14}, 8}, {{16, 36, 30}, 5}};
  MarkerWish wish;
  wish.radius = 5;
  const Markers m = found_in(balls({48, 48, 44}, all, 0.05, 8), wish);
  tell(m);
  ASSERT_EQ(m.found.size(), 2u);
  for (const Marker& f : m.found) {
    EXPECT_EQ(f.radius, 5);
    EXPECT_EQ(f.sigma_radius, 0);
  }
}

TEST(Markers, UnequalSpacingsGiveIndicesBack) {
  const Ball one{{20, 21, 25}, 9};
  const Vec3 scale{1, 1, 2.5};
  MarkerWish wish;
  wish.scale = scale;
  const auto data = balls({40, 42, 20}, {one}, 0.03, 3, scale);
  const Markers m = found_in(data, wish);
  tell(m);
  ASSERT_EQ(m.found.size(), 1u);
  EXPECT_LT(norm(m.found[0].centre * scale - one.centre), 0.1);
  EXPECT_NEAR(m.found[0].radius, 9, 0.1);
}

TEST(Markers, ConstantVolumesAndThresholdsAboveEverythingAreRefused) {
  const auto data = phantom::sampled({8, 8, 8}, [](Vec3) { return 1.0; });
  try {
    markers(*phantom::in_memory(data), {}, 5000, {});
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), Exit::data);
    EXPECT_THAT(e.what(), HasSubstr("5000"));
  }
}

}  // namespace
}  // namespace gonio::volume
