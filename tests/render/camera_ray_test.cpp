// Rays through a thin lens against its closed forms.
#include "render/camera_ray.h"

#include <gtest/gtest.h>

#include "base/random.h"
#include "scenes.h"

namespace gonio::render {
namespace {

scene::View view_of(const camera::CameraModel& camera, const scene::ThinLens& lens) {
  scene::Scene scene = tests::SceneBuilder().view(camera, {0.3, -0.2, 1.1}, {0.4, 0.2, -0.7}).scene();
  scene.views[0].lens = lens;
  return scene.views[0];
}
// Where a ray meets the plane of depth z of the camera frame.
Vec3 at_depth(const scene::View& view, const WorldRay& ray, double z) {
  const auto camera_from_world = inverse(view.world_from_camera);
  const Vec3 origin = camera_from_world * ray.origin_m, direction = camera_from_world.rotate(ray.direction);
  return origin + direction * ((z - origin.z) / direction.z);
}

TEST(CameraRay, WithoutApertureIsThePinholesToTheLastBit) {
  const scene::View view = view_of(tests::pinhole(64, 80), {});
  const CameraRays rays(view);
  EXPECT_FALSE(rays.uses_lens());
  const WorldRay a = rays.at({3, 50}, {0.1, 0.9}), b = rays.principal({3, 50});
  EXPECT_EQ(a.origin_m, b.origin_m);
  EXPECT_EQ(a.direction, b.direction);
  EXPECT_EQ(a.origin_m, view.world_from_camera.translation_m);
}

TEST(CameraRay, ThePlaneInFocusIsSharpAndOthersSpreadOverTheCircleOfConfusion) {
  constexpr double radius = 0.02, focus = 0.8, f_px = 80;
  camera::Intrinsics distorted = tests::pinhole_lens(64, f_px);
  distorted.distortion[camera::LensTerm::k1] = -0.1;
  for (const camera::CameraModel& camera : {tests::pinhole(64, f_px), camera::CameraModel(distorted, 64, 64)}) {
    const scene::View view = view_of(camera, {radius, focus});
    const CameraRays rays(view);
    Random random(2);
    for (const double z : {0.4, 0.8, 1.7}) {
      const Vec2 pixel{31.5, 31.5};
      double widest = 0, mean_square = 0;
      constexpr int draws = 20000;
      for (int k = 0; k < draws; ++k) {
        const double u = random.uniform();
        const Vec3 spot = at_depth(view, rays.at(pixel, {u, random.uniform()}), z);
        const Vec3 sharp = at_depth(view, rays.principal(pixel), z);
        const double away_px = norm(spot - sharp) * f_px / z;
        widest = std::max(widest, away_px);
        mean_square += away_px * away_px / draws;
      }
      const double blur_px = radius * f_px * std::abs(1 / z - 1 / focus);  // half the diameter
      EXPECT_NEAR(widest, blur_px, 2e-3 * blur_px + 1e-9) << z;
      EXPECT_NEAR(mean_square, blur_px * blur_px / 2, 0.02 * blur_px * blur_px + 1e-12) << z;  // of a uniform disc
    }
  }
}

TEST(CameraRay, OrthographicConesAreAsWideEverywhere) {
  const scene::View view = view_of(camera::CameraModel::parallel(100, 10, 10), {0.01, 0.5});
  const CameraRays rays(view);
  for (const Vec2 pixel : {Vec2{0, 0}, Vec2{9, 3}}) {
    const Vec3 sharp = at_depth(view, rays.principal(pixel), 0.75);
    const Vec3 spot = at_depth(view, rays.at(pixel, {1, 0.5}), 0.75);
    EXPECT_NEAR(norm(spot - sharp), 0.01 * (0.75 / 0.5 - 1), 1e-12);
  }
}

}  // namespace
}  // namespace gonio::render
