// Air that scatters: the glow along a line by brute force, limits, and what no air does.
#include <gtest/gtest.h>

#include "base/random.h"
#include "scene/mechanisms/volume_fog.h"

namespace gonio::tests {
namespace {

Vec3 somewhere(Random& random) {
  return {random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)};
}

TEST(Fog, GlowsAsAFineSumAlongTheLineSays) {
  Random random(3, 1);
  for (int i = 0; i < 40; ++i) {
    const double sigma = random.uniform(0.05, 2), albedo = random.uniform(0.2, 1), way = random.uniform(0.2, 2);
    const Vec3 eye = somewhere(random), along = normalized(somewhere(random));
    // A lamp beside the line, as near as a centimetre.
    const Vec3 beside = normalized(cross(along, somewhere(random)));
    const Vec3 lamp = eye + along * random.uniform(-0.5, 1.5) + beside * std::pow(10, random.uniform(-2, 0));
    constexpr int parts = 400000;
    double sum = 0;
    for (int k = 0; k < parts; ++k) {
      const double s = way * (k + 0.5) / parts, r = norm(eye + along * s - lamp);
      sum += std::exp(-sigma * s - equation::volume_fog_lost_per_m(sigma, albedo) * r) / (r * r);
    }
    const double exact = albedo * sigma / (4 * pi) * sum * way / parts;
    EXPECT_NEAR(equation::volume_fog_glow(sigma, albedo, eye, along, way, lamp), exact, 2e-3 * exact) << i;
  }
}

TEST(Fog, ThinAirTakesNothingAndGivesNothing) {
  EXPECT_EQ(equation::volume_fog_passes(0, 3), 1);
  EXPECT_EQ(equation::volume_fog_glow(0, 0.8, {}, {1, 0, 0}, 2, {1, 1, 0}), 0);
  EXPECT_EQ(equation::volume_fog_glow(0, 0.8, 2), 0);
  EXPECT_EQ(equation::volume_fog_veil(0, 0.8, 2), 0);
}

// A far lamp of as much irradiance glows as a distant one does, as long as the air takes nothing before.
TEST(Fog, ADistantLampIsTheLimitOfAFarOne) {
  constexpr double far = 1e4, sigma = 1e-6, way = 2;
  const double near = equation::volume_fog_glow(sigma, 0.8, {}, {1, 0, 0}, way, {0, 0, far}) * far * far,
               distant = equation::volume_fog_glow(sigma, 0.8, way);
  EXPECT_NEAR(near / distant, 1, 0.01);
}

}  // namespace
}  // namespace gonio::tests
