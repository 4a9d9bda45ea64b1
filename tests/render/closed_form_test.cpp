// The path tracer against closed forms. Statistical tests use its own variances: |z| < 4.5, false alarm 7e-6 each.
#include <gtest/gtest.h>

#include "light/irradiance.h"
#include "scenes.h"

namespace gonio::render {
namespace {

using tests::mean_of;
using tests::MeanAndError;
using tests::pinhole;
using tests::render_view;
using tests::SceneBuilder;

constexpr double z_limit = 4.5;

void expect_value(const MeanAndError& found, double truth, double exact = 1e-6) {
  EXPECT_NEAR(found.mean, truth, z_limit * found.sigma + exact * truth) << "z = " << (found.mean - truth) / found.sigma;
}

TEST(ClosedForm, PointLightInverseSquareAndCosine) {
  for (const double height_m : {0.1, 0.4, 2.0})
    for (const double x : {0.0, 0.3, 1.0}) {
      SceneBuilder builder;
      builder.object(scene::Plane{10, 10}, builder.diffuse(0.7));
      builder.light("point", {{"position_m", std::vector<double>{0, 0, height_m}}, {"watt_per_sr", 2.0}});
      const auto scene = builder.look_down(x, 0, 1e-6).scene();
      const double square = x * x + height_m * height_m;
      expect_value(mean_of(render_view(scene, {.spp = 16})), 0.7 / pi * 2 * height_m / (square * std::sqrt(square)),
                   1e-5);
    }
}

TEST(ClosedForm, DirectionalLight) {
  SceneBuilder builder;
  builder.object(scene::Plane{1, 1}, builder.diffuse(0.4));
  builder.light("directional", {{"towards", std::vector<double>{3, 0, 4}}, {"watt_per_m2", 5.0}});
  const auto scene = builder.look_down(0, 0, 0.5).scene();
  expect_value(mean_of(render_view(scene, {.spp = 16})), 0.4 / pi * 5 * 0.8);
}

TEST(ClosedForm, SphereLightAboveAndAcrossTheHorizon) {
  struct Case {
    double x, height_m;
  };
  for (const Case c : {Case{0, 0.3}, Case{0.2, 0.25}, Case{0.3, 0.05}, Case{0.4, -0.05}})
    for (const double f0 : {0.0, 0.04}) {  // a coat draws directions that meet the lamp, too
      SceneBuilder builder;
      builder.object(scene::Plane{10, 10},
                     f0 > 0 ? builder.surface("coated-diffuse", {{"albedo", 0.6}, {"f0", f0}, {"alpha", 0.5}})
                            : builder.diffuse(0.6));
      builder.light("sphere",
                    {{"position_m", std::vector<double>{0, 0, c.height_m}}, {"watt_per_sr", 1.0}, {"radius_m", 0.1}});
      builder.look_down(c.x, 0, 1e-6, 8, 0.2);  // below the lamp where it would be in the way
      const auto scene = builder.scene();
      const MeanAndError found = mean_of(render_view(scene, {.spp = 1024}));
      const Rgb truth = light::sphere_irradiance({1, 1, 1}, {0, 0, c.height_m}, 0.1, {c.x, 0, 0}, {0, 0, 1});
      if (f0 == 0) expect_value(found, 0.6 / pi * truth.x, 1e-5);
      const MeanAndError other =
          mean_of(render_view(scene, {.spp = 4096, .seed = 5, .transport = {.estimator = Estimator::lights_only}}));
      EXPECT_NEAR(found.mean, other.mean, z_limit * std::hypot(found.sigma, other.sigma) + 1e-7 * found.mean);
    }
}

TEST(ClosedForm, UniformEnvironmentOnAPlane) {
  SceneBuilder builder;
  builder.object(scene::Plane{1, 1}, builder.diffuse(0.3));
  builder.light("uniform", {{"radiance", 2.0}});
  const auto scene = builder.look_down(0, 0, 0.5).scene();
  expect_value(mean_of(render_view(scene, {.spp = 1024})), 0.3 * 2);
}

// Everything white under uniform light of radiance 1 is invisible: every pixel is 1.
TEST(WhiteFurnace, OpenSceneWithConcavities) {
  SceneBuilder builder;
  const std::size_t white = builder.diffuse(1);
  builder.object(scene::Plane{0.6, 0.6}, white);
  builder.object(scene::Sphere{0.1}, white, {-0.05, 0, 0.1});
  builder.object(scene::Sphere{0.06}, white, {0.1, 0.02, 0.06});
  builder.object(
      std::make_shared<const mesh::Mesh>(mesh::prepare(tests::globe(0.05, 20, 40), mesh::Shading::flat, "globe")),
      white, {0.05, -0.12, 0.05});
  builder.light("uniform", {{"radiance", 1.0}});
  const auto scene = builder.view(pinhole(32, 40), {0, 0, 0.6}, {pi, 0, 0}).scene();
  const io::Image image = render_view(scene, {.spp = 256});
  const MeanAndError all = mean_of(image);
  EXPECT_NEAR(all.mean, 1, 1e-3);
  EXPECT_LT(all.sigma, 1e-3);
  EXPECT_NEAR(all.mean, 1, z_limit * all.sigma);
}

// Inside a sphere of albedo a with a point light at its centre (integrating sphere): L = a / (1 - a) I / (pi R^2).
TEST(WhiteFurnace, ClosedSphere) {
  for (const double albedo : {0.2, 0.5}) {
    SceneBuilder builder;
    builder.object(scene::Sphere{0.5}, builder.diffuse(albedo));
    builder.light("point", {{"position_m", std::vector<double>{0, 0, 0}}, {"watt_per_sr", 1.0}});
    const auto scene = builder.view(pinhole(16, 12), {0.1, 0.2, 0.1}, {0.3, 0.4, 0.5}).scene();
    const MeanAndError found = mean_of(render_view(scene, {.spp = 4096}));
    const double truth = albedo / (1 - albedo) / (pi * 0.25);
    EXPECT_NEAR(found.mean, truth, 1e-3 * truth);
    EXPECT_NEAR(found.mean, truth, z_limit * found.sigma + 1e-6 * truth);
  }
}

// Form factor between a small patch and a parallel disk-like luminous plate is tested through one bounce: two coaxial
// parallel unit squares at unit distance, F = 0.199825 (Howell, configuration C-11). The lower is black to the eye but
// for what the upper sends.
TEST(ClosedForm, FormFactorOfParallelSquares) {
  SceneBuilder builder;
  builder.object(scene::Plane{1, 1}, builder.diffuse(0.5));
  builder.object(scene::Plane{1, 1}, builder.diffuse(0), {0, 0, 1});
  builder.light("uniform", {{"radiance", 1.0}});
  builder.look_down(0, 0, 1, 16, 0.9);  // from below the upper square, all of the lower one
  // The lower square receives pi (1 - F) from the environment that the black upper one does not hide.
  expect_value(mean_of(render_view(builder.scene(), {.spp = 1024})), 0.5 * (1 - 0.199825), 2e-6);
}

// A wall and a floor of one albedo each: the radiance after exactly two events, against a quadrature of the double
// integral.
TEST(ClosedForm, OneInterreflection) {
  SceneBuilder builder;
  builder.object(scene::Plane{10, 10}, builder.diffuse(0.5));
  builder.object(scene::Plane{0.2, 0.2}, builder.diffuse(0.8), {0, 0.3, 0.1}, {pi / 2, 0, 0});  // faces -y
  builder.light("directional", {{"towards", std::vector<double>{0, -1, 0}}, {"watt_per_m2", 1.0}});
  const auto scene = builder.look_down(0, 0.2, 1e-6).scene();
  double irradiance = 0;  // at (0, 0.2, 0), from the wall of radiance 0.8 / pi
  const int n = 400;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const Vec3 arm{-0.1 + 0.2 * (i + 0.5) / n, 0.1, 0.2 * (j + 0.5) / n};
      const double square = dot(arm, arm);
      irradiance += 0.8 / pi * arm.z * arm.y / (square * square) * (0.04 / (n * n));
    }
  const MeanAndError found = mean_of(render_view(scene, {.spp = 4096, .transport = {.max_bounces = 2}}));
  expect_value(found, 0.5 / pi * irradiance, 1e-4);
}

}  // namespace
}  // namespace gonio::render
