// lib/probe/mirror_ball.h: the two ways between rays and directions agree, and every slope is the true one.
#include "probe/mirror_ball.h"

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/random.h"
#include "probe/metals.h"

namespace gonio::probe {
namespace {

Vec3 any_direction(Random& random) {
  const double z = random.uniform(-1, 1), phi = random.uniform(0, 2 * pi), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}
double angle_between(Vec3 a, Vec3 b) {
  return std::atan2(norm(cross(a, b)), dot(a, b));
}

class AnyBall : public testing::TestWithParam<int> {};

// The eye looks at the point that shows a direction; the law of reflection leads back into the direction.
TEST_P(AnyBall, ShowsADirectionWhereReflectionSendsItToTheEye) {
  Random random(7, static_cast<std::uint64_t>(GetParam()));
  const Ball ball{{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1)}, random.uniform(0.01, 0.1)};
  const Vec3 eye = ball.centre_m + any_direction(random) * (ball.radius_m * random.uniform(1.5, 60));
  const MirrorBall mirror(ball, eye);
  int blind = 0;
  for (int k = 0; k < 200; ++k) {
    const Vec3 d = any_direction(random);
    const double distance = k % 2 == 0 ? HUGE_VAL : ball.radius_m * random.uniform(1.5, 50);
    const auto shown = mirror.shown(d, distance);
    if (distance == HUGE_VAL) {
      EXPECT_EQ(shown.has_value(), angle_between(d, -mirror.towards_eye()) > mirror.blind_half_angle_rad());
    }
    if (!shown) {
      ++blind;
      continue;
    }
    const auto back = mirror.reflect(eye, normalized(shown->point_m - eye));
    ASSERT_TRUE(back);
    if (shown->cosine < 1e-3) continue;  // the ray may miss the ball by rounding
    const Vec3 wanted = distance == HUGE_VAL ? d : normalized(ball.centre_m + d * distance - shown->point_m);
    EXPECT_LT(angle_between(back->direction, wanted), 1e-8);
    EXPECT_NEAR(back->cosine, shown->cosine, 1e-9);
    EXPECT_NEAR(back->offset, shown->offset, 1e-9);
  }
  EXPECT_LT(blind, 200);
}
INSTANTIATE_TEST_SUITE_P(Seeds, AnyBall, testing::Range(0, 10));

TEST(MirrorBall, SpreadIsTheSlopeOfTheDirection) {
  const Ball ball{{0, 0, 0.3}, 0.05};
  const MirrorBall near(ball, {0, 0, 0}), far = MirrorBall::parallel(ball, {0, 0, -1});
  for (const double s : {0.05, 0.3, 0.7, 0.95}) {
    constexpr double h = 1e-5;
    const double a = ball.radius_m / 0.3;  // the sine of the outline's angle
    const auto turned = [&](double offset, double round, bool perspective) {
      const double sine = offset * a;
      const Vec3 sideways{std::cos(round), std::sin(round), 0};
      return perspective ? near.reflect({}, sideways * sine + Vec3{0, 0, std::sqrt(1 - sine * sine)})->direction
                         : far.reflect(sideways * (offset * ball.radius_m), {0, 0, 1})->direction;
    };
    for (const bool perspective : {true, false}) {
      const Vec2 spread = (perspective ? near : far).spread_rad(s);
      EXPECT_NEAR(angle_between(turned(s + h, 0, perspective), turned(s - h, 0, perspective)) / (2 * h), spread.x,
                  1e-4 * spread.x);
      EXPECT_NEAR(angle_between(turned(s, h, perspective), turned(s, -h, perspective)) / (2 * h * s), spread.y,
                  1e-4 * spread.y);
    }
  }
}

// All that the ball shows, and the blind cone, make up the sphere.
TEST(MirrorBall, SolidAnglesOfThePictureAndTheBlindConeSumToTheSphere) {
  for (const double distance : {0.06, 0.3, 3.0}) {
    const MirrorBall mirror({{}, 0.05}, {0, distance, 0});
    double sum = 0;
    constexpr int n = 20000;  // in the incidence, where the integrand is smooth up to the outline
    for (int k = 0; k < n; ++k) {
      const double i = (k + 0.5) / n * pi / 2, s = std::sin(i);
      const Vec2 spread = mirror.spread_rad(s);
      sum += spread.x * spread.y * 2 * pi * s * std::cos(i) * (pi / 2 / n);
    }
    EXPECT_NEAR(sum + 2 * pi * (1 - std::cos(mirror.blind_half_angle_rad())), 4 * pi, 3e-4);
  }
}

TEST(MirrorBall, RefusesAnEyeWithin) {
  EXPECT_THROW(MirrorBall({{}, 0.05}, {0, 0, 0.04}), Error);
  EXPECT_THROW(MirrorBall({{}, 0}, {0, 0, 0.04}), Error);
}

TEST(Metals, ReflectAsTheirIndexSays) {
  // ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2) of Johnson & Christy's chromium at 549 nm.
  EXPECT_NEAR(metal_of("chromium", "--metal").reflectance(1).y,
              (2.18 * 2.18 + 3.33 * 3.33) / (4.18 * 4.18 + 3.33 * 3.33), 0.01);
  EXPECT_GT(metal_of("silver", "--metal").reflectance(1).y, 0.95);
  for (const std::string& name : metal_names()) {
    const Metal metal = metal_of(name, "--metal");
    for (const double cosine : {1.0, 0.5, 0.0})
      for (int c = 0; c < 3; ++c) {
        EXPECT_GT(metal.reflectance(cosine)[c], 0.4);
        EXPECT_LE(metal.reflectance(cosine)[c], 1);
      }
    EXPECT_NEAR(metal.reflectance(0).x, 1, 1e-9);
  }
  // What the specimen "mirror-ball" of render is made of.
  const Metal chromium = metal_of("chromium", "--metal");
  const Rgb eta{3.219, 3.054, 2.37}, k{3.31, 3.314, 3.141};
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(chromium.eta[c], eta[c], 0.005);
    EXPECT_NEAR(chromium.k[c], k[c], 0.005);
  }
  EXPECT_THROW(metal_of("unobtainium", "--metal"), Error);
}

}  // namespace
}  // namespace gonio::probe
