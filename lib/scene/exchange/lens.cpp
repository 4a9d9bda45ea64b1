// The pinhole beneath a camera model. Focal lengths are the slopes of the projection on its axis; the distortion is
// measured on a grid of pixels by comparing the ray's tangents with those of the pinhole.
#include "scene/exchange/lens.h"

#include <algorithm>
#include <cmath>

namespace gonio::scene {
namespace {

double slope(const camera::CameraModel& camera, Vec3 step, double at_zero, bool along_y) {
  const auto pixel = camera.project(step + Vec3{0, 0, 1});
  if (!pixel) return 0;
  return ((along_y ? pixel->y : pixel->x) - at_zero) / (along_y ? step.y : step.x);
}

double distortion(const camera::CameraModel& camera, const Lens& lens) {
  constexpr int steps = 8;
  double worst = 0;
  for (int i = 0; i <= steps; ++i)
    for (int j = 0; j <= steps; ++j) {
      const Vec2 pixel{(lens.width - 1.0) * i / steps, (lens.height - 1.0) * j / steps};
      const Vec3 d = camera.ray(pixel).direction;
      if (!(d.z > 1e-3)) return std::max(lens.width, lens.height);
      worst = std::max(worst, norm(Vec2{lens.fx * d.x / d.z + lens.cx, lens.fy * d.y / d.z + lens.cy} - pixel));
    }
  return worst;
}

}  // namespace

Lens lens_of(const View& view) {
  const camera::CameraModel& camera = view.camera;
  Lens lens{.orthographic = camera.orthographic(),
            .cx = camera.principal_point_px().x,
            .cy = camera.principal_point_px().y,
            .width = camera.width_px(),
            .height = camera.height_px()};
  constexpr double step = 1e-4;
  lens.fx = slope(camera, {step, 0, 0}, lens.cx, false);
  lens.fy = slope(camera, {0, step, 0}, lens.cy, true);
  if (!lens.orthographic) lens.distortion_px = distortion(camera, lens);
  return lens;
}

Stand stand_of(const View& view) {
  const auto& pose = view.world_from_camera;
  return {pose.translation_m, pose * Vec3{0, 0, 1}, pose.rotate({0, -1, 0})};
}

}  // namespace gonio::scene
