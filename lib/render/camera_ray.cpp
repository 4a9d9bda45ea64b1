#include "render/camera_ray.h"

#include "light/warp.h"

namespace gonio::render {

WorldRay CameraRays::principal(Vec2 pixel) const {
  const camera::Ray ray = view_.camera.ray(pixel);
  return {rotation_ * ray.origin_m + view_.world_from_camera.translation_m, rotation_ * ray.direction};
}

WorldRay CameraRays::at(Vec2 pixel, Vec2 lens_u) const {
  if (!uses_lens()) return principal(pixel);
  const camera::Ray ray = view_.camera.ray(pixel);
  if (!(ray.direction.z > 0)) return principal(pixel);
  const Vec2 offset = light::on_disc(lens_u) * view_.lens.aperture_radius_m;
  const Vec3 sharp = ray.origin_m + ray.direction * (view_.lens.focus_m / ray.direction.z);
  const Vec3 origin = ray.origin_m + Vec3{offset.x, offset.y, 0};
  return {rotation_ * origin + view_.world_from_camera.translation_m, rotation_ * normalized(sharp - origin)};
}

}  // namespace gonio::render
