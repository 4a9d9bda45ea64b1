#include "render/caustic_camera.h"

#include <cmath>

#include "light/warp.h"

namespace gonio::render {

CausticCamera::CausticCamera(const scene::View& view)
    : view_(view),
      world_from_camera_(matrix_of(view.world_from_camera.rotation)),
      camera_from_world_(transposed(world_from_camera_)) {}

// The ray from the lens' point through `local_m` meets the sharp plane where the pinhole's ray does.
std::optional<Vec2> CausticCamera::pixel(Vec3 local_m, Vec2 offset_m) const {
  const double along = local_m.z / view_.lens.focus_m;
  if (view_.camera.orthographic())
    return view_.camera.project(
        {local_m.x - offset_m.x * (1 - along), local_m.y - offset_m.y * (1 - along), local_m.z});
  if (!uses_lens() || !(local_m.z > 0)) return view_.camera.project(local_m);
  const Vec3 lens{offset_m.x, offset_m.y, 0};
  return view_.camera.project(lens + (local_m - lens) * (1 / along));
}

std::optional<Sight> CausticCamera::sight(Vec3 point_m, Vec2 lens_u) const {
  const Vec3 local = camera_from_world_ * (point_m - view_.world_from_camera.translation_m);
  const bool orthographic = view_.camera.orthographic();
  if (orthographic && !(local.z > 0)) return {};
  const Vec2 offset = uses_lens() && local.z > 0 ? light::on_disc(lens_u) * view_.lens.aperture_radius_m : Vec2{};
  const auto at = pixel(local, offset);
  if (!at || at->x < -0.5 || at->y < -0.5 || at->x >= view_.camera.width_px() - 0.5 ||
      at->y >= view_.camera.height_px() - 0.5)
    return {};
  Vec3 origin{offset.x, offset.y, 0};
  if (orthographic) {
    const double along = local.z / view_.lens.focus_m;
    origin = uses_lens() ? Vec3{local.x + offset.x * along, local.y + offset.y * along, 0} : Vec3{local.x, local.y, 0};
  }
  const Vec3 arm = local - origin;
  const double distance = norm(arm), h = 1e-4 * distance;
  if (!(distance > 0)) return {};
  const Basis frame(arm / distance);
  const auto slope = [&](Vec3 step) -> std::optional<Vec2> {
    const auto a = pixel(local + step * h, offset), b = pixel(local - step * h, offset);
    if (!a || !b) return {};
    return (*a - *b) * (0.5 / h);
  };
  const auto x = slope(frame.t), y = slope(frame.b);
  if (!x || !y) return {};
  return Sight{world_from_camera_ * origin + view_.world_from_camera.translation_m, *at,
               std::abs(x->x * y->y - x->y * y->x)};
}

}  // namespace gonio::render
