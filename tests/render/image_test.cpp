// What a rendered picture contains: geometry channels, cameras with distortion, settings of the scene.
#include <gtest/gtest.h>

#include "scenes.h"

namespace gonio::render {
namespace {

using tests::pinhole;
using tests::pinhole_lens;
using tests::render_view;
using tests::SceneBuilder;

SceneBuilder ball_on_table() {
  SceneBuilder builder;
  builder.object(scene::Plane{0.6, 0.6}, builder.diffuse(0.5));
  builder.object(scene::Sphere{0.1}, builder.diffuse(0.8), {0, 0, 0.1});
  builder.light("point", {{"position_m", std::vector<double>{0.3, -0.2, 0.5}}, {"watt_per_sr", 1.0}});
  return builder;
}

TEST(Geometry, PositionsProjectToTheirPixelsThroughADistortedLens) {
  using camera::LensTerm;
  camera::Intrinsics lens = pinhole_lens(40, 45);
  lens.distortion[LensTerm::k1] = -0.28, lens.distortion[LensTerm::k2] = 0.07;
  lens.distortion[LensTerm::p1] = 0.002, lens.distortion[LensTerm::p2] = -0.001;
  lens.distortion[LensTerm::s1] = 0.003, lens.distortion[LensTerm::s3] = -0.002;
  const auto scene = ball_on_table().view({lens, 40, 40}, {0.05, -0.3, 0.5}, {-2.6, 0.1, 0.05}).scene();
  const io::Image image = render_view(scene, {.spp = 4});
  const int id = image.channel("id"), position = image.channel("position.X"), normal = image.channel("normal.X");
  const auto camera_from_world = inverse(scene.views[0].world_from_camera);
  int met = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      if (image.at(x, y, id) == 0) continue;
      ++met;
      const Vec3 p{image.at(x, y, position), image.at(x, y, position + 1), image.at(x, y, position + 2)};
      const Vec3 n{image.at(x, y, normal), image.at(x, y, normal + 1), image.at(x, y, normal + 2)};
      const auto pixel = scene.views[0].camera.project(camera_from_world * p);
      ASSERT_TRUE(pixel);
      EXPECT_NEAR(pixel->x, x, 1e-4);
      EXPECT_NEAR(pixel->y, y, 1e-4);
      EXPECT_NEAR(norm(n), 1, 1e-6);
      if (image.at(x, y, id) == 2) {
        EXPECT_NEAR(norm(p - Vec3{0, 0, 0.1}), 0.1, 1e-7);
      }
    }
  EXPECT_GT(met, 800);
}

TEST(Geometry, DistanceAndVisibilityOfLights) {
  auto builder = ball_on_table();
  builder.light("directional", {{"towards", std::vector<double>{0, 0, 1}}, {"watt_per_m2", 1.0}});
  const auto scene = builder.look_down(0, 0, 0.5, 50).scene();
  const io::Image image = render_view(scene, {.spp = 16});
  const int distance = image.channel("distance.l0"), visibility = image.channel("visibility.l1");
  ASSERT_GE(distance, 0);
  // Straight above the ball's top (between pixels 24 and 25).
  EXPECT_NEAR(image.at(24, 24, distance), std::hypot(0.3, -0.2, 0.3), 0.01);
  EXPECT_EQ(image.at(24, 24, visibility), 1);
  EXPECT_EQ(image.at(1, 1, visibility), 1);
  EXPECT_EQ(image.at(1, 1, image.channel("distance.l1")), 0);  // infinitely far
  // In the point light's shadow: opposite to (0.3, -0.2), just beyond the ball.
  EXPECT_EQ(image.at(11, 15, image.channel("visibility.l0")), 0);
}

TEST(Settings, IndirectStrengthScalesWhatWasScatteredTwice) {
  auto scene = ball_on_table().look_down(0, 0, 0.4, 16).scene();
  const auto render_at = [&](double strength, int bounces) {
    scene.appearance.indirect_strength = strength;
    return render_view(scene, {.spp = 64, .seed = 3, .geometry = false, .transport = {.max_bounces = bounces}});
  };
  const io::Image full = render_at(1, 128), none = render_at(0, 128), half = render_at(0.5, 128),
                  single = render_at(1, 1);
  double more = 0;
  for (std::size_t i = 0; i < full.data.size(); i += 6) {
    EXPECT_NEAR(half.data[i], 0.5 * (full.data[i] + none.data[i]), 1e-6);
    EXPECT_EQ(none.data[i], single.data[i]);  // paths have numbers of their own: longer ones do not disturb the others
    more += full.data[i] - none.data[i];
  }
  EXPECT_GT(more, 0);
}

TEST(Settings, VignettingFallsWithTheSquareOfTheRadius) {
  SceneBuilder builder;
  builder.object(scene::Plane{4, 4}, builder.diffuse(1));
  builder.light("directional", {{"towards", std::vector<double>{0, 0, 1}}, {"watt_per_m2", pi}});
  auto scene = builder.look_down(0, 0, 1, 33).scene();
  const auto pixel_mean = [&](double falloff, double r2) { return 1 - falloff * (r2 + 1.0 / 6) / (16.5 * 16.5); };
  scene.appearance.vignetting_falloff = 0.2;
  const io::Image image = render_view(scene, {.spp = 64, .geometry = false});
  EXPECT_NEAR(image.at(16, 16, 0), pixel_mean(0.2, 0), 1e-4);
  EXPECT_NEAR(image.at(0, 16, 0), pixel_mean(0.2, 256), 2e-3);
  EXPECT_NEAR(image.at(32, 32, 0), pixel_mean(0.2, 512), 2e-3);
}

TEST(Settings, GainMultipliesAndLightsAreChosenPerImage) {
  auto builder = ball_on_table();
  builder.light("point", {{"position_m", std::vector<double>{-0.3, 0, 0.5}}, {"watt_per_sr", 2.0}});
  auto scene = builder.look_down(0, 0, 0.4, 8).scene();
  const Options options{.spp = 16, .geometry = false};
  const double both = tests::mean_of(render_view(scene, options)).mean;
  scene.views[0].lights = {0};
  const double first = tests::mean_of(render_view(scene, options)).mean;
  scene.views[0].lights = {1};
  const double second = tests::mean_of(render_view(scene, options)).mean;
  EXPECT_NEAR(first + second, both, 0.02 * both);
  scene.views[0].gain = {2, 2, 2};
  EXPECT_NEAR(tests::mean_of(render_view(scene, options)).mean, 2 * second, 1e-6 * second);
}

TEST(Lamps, AreSeenByTheCameraAndInMirrors) {
  SceneBuilder builder;
  builder.object(scene::Plane{1, 1}, builder.surface("metal", {{"f0", 1.0}, {"alpha", 0.02}}));
  builder.light("sphere", {{"position_m", std::vector<double>{0, 0.2, 0.3}}, {"watt_per_sr", 1.0}, {"radius_m", 0.05}});
  const double radiance = 1 / (pi * 0.0025);
  auto direct = builder;
  const auto straight = direct.view(pinhole(8, 400), {0, 0.2, 2}, {pi, 0, 0}).scene();
  EXPECT_NEAR(tests::mean_of(render_view(straight, {.spp = 16})).mean, radiance, 1e-6 * radiance);
  // From (0, -0.2, 0.3) to the lamp's mirror image at (0, 0.2, -0.3).
  const Vec3 forward = normalized(Vec3{0, 0.4, -0.6});
  const double tilt = -std::acos(forward.z);
  const auto mirrored = builder.view(pinhole(8, 400), {0, -0.2, 0.3}, {tilt, 0, 0}).scene();
  // Facets tilted by more than half the lamp's angular radius, tan = 0.0693, send other directions: alpha^2 / (alpha^2
  // + tan^2).
  const double caught = 1 - 0.0004 / (0.0004 + 0.0693 * 0.0693);
  EXPECT_NEAR(tests::mean_of(render_view(mirrored, {.spp = 256})).mean, caught * radiance, 0.02 * radiance);
}

}  // namespace
}  // namespace gonio::render
