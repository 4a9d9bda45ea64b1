// See make_cell.h.
#include <algorithm>

#include "glass/make_cell.h"
#include "render/media.h"
#include "render/path_setting.h"
#include "render/ray_caster.h"
#include "scene/scene.h"
#include "surface/refraction.h"

namespace gonio::glass {
namespace {

constexpr int most = 64;

// Interfaces that the ray crosses or is totally reflected at. Bands bend alike here: the middle one counts.
int interfaces(const render::RayCaster& caster, const render::Media& media, render::WorldRay ray) {
  render::Inside inside = media.around(ray.origin_m);
  std::optional<render::SurfacePoint> hit = caster.closest(ray.origin_m, ray.direction);
  int count = 0;
  for (int step = 0; hit && media.holds(hit->instance) && step < 4 * most && count < most; ++step) {
    const render::Crossing crossing = media.crossing(inside, *hit);
    render::SurfacePoint from = render::beyond(*hit);
    if (!crossing.passes) {
      ++count;
      const double c = -dot(ray.direction, hit->normal), eta = crossing.eta.y;
      if (1 - (1 - c * c) / (eta * eta) > 0) {
        ray.direction = surface::refracted(-ray.direction, hit->normal, eta);
        inside = crossing.inside_beyond;
      } else {
        ray.direction = normalized(ray.direction + hit->normal * (2 * c));
        from = *hit;
      }
    } else {
      inside = crossing.inside_beyond;
    }
    hit = caster.closest_from(from, ray.direction);
  }
  return count;
}

}  // namespace

RayDepth ray_depth(const Cell& cell) {
  const scene::Scene scene = scene::build_scene(cell.scene, {});
  const render::RayCaster caster(scene.instances);
  const render::Media media(scene, caster);
  const scene::View& view = scene.views.front();
  RayDepth depth;
  depth.count.assign(most + 1, 0);
  double sum = 0;
  const render::CameraRays rays(view);
  const int width = view.camera.width_px(), height = view.camera.height_px();
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const int n = interfaces(caster, media, rays.principal({static_cast<double>(x), static_cast<double>(y)}));
      ++depth.count[static_cast<std::size_t>(n)];
      sum += n, depth.largest = std::max(depth.largest, n);
    }
  const auto met = static_cast<double>(width) * height - static_cast<double>(depth.count[0]);
  depth.mean = met > 0 ? sum / met : 0;
  return depth;
}

}  // namespace gonio::glass
