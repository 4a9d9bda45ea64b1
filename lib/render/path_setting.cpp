#include "render/path_setting.h"

#include <cmath>

#include "light/mechanisms/light_ambient.h"

namespace gonio::render {
namespace {

// False where the surface has nothing but perfectly smooth lobes: no density along the mirrored direction, where a
// rough lobe has its peak, nor along the normal and back, between whatever indices.
bool may_spread(const scene::Surface& surface) {
  if (surface.varies() || surface.base || !surface.model->transmits()) return true;
  for (const double sine : {0.0, 0.3, 0.6, 0.9, 0.99}) {
    const Vec3 wo{sine, 0, std::sqrt(1 - sine * sine)};
    for (const Vec3 wi : {Vec3{-wo.x, 0, wo.z}, Vec3{0, 0, 1}, wo, Vec3{-wo.x, 0, -wo.z}, Vec3{0, 0, -1}})
      for (const double eta : {1.5, 1 / 1.5}) {
        surface::Values values = surface.values;
        values.eta = {eta, eta, eta};
        if (surface.model->pdf(values, wo, wi) > 0) return true;
      }
  }
  return false;
}

}  // namespace

PathSetting::PathSetting(const scene::Scene& the_scene, std::size_t number, const RayCaster& the_caster,
                         const Transport& the_transport)
    : scene(the_scene),
      view(the_scene.views[number]),
      caster(the_caster),
      transport(the_transport),
      rays(view),
      x_axis(view.world_from_camera.rotate({1, 0, 0})),
      media(the_scene, the_caster) {
  for (const std::size_t light : view.lights) emitters.push_back(scene.appearance.lights[light].emitter.get());
  named = emitters.size();
  if (scene.appearance.ambient) emitters.push_back(scene.appearance.ambient.get());
  for (const scene::Surface& surface : scene.appearance.surfaces) {
    transmits.push_back(surface.model->transmits() || surface.model->thin());
    spreads.push_back(may_spread(surface));
  }
  if (media.any()) camera_inside = media.around(view.world_from_camera.translation_m);
  if (transport.from_lights) caustics.emplace(scene, emitters);
  if (caustics && !caustics->any()) caustics.reset();
}

Rgb PathSetting::scale(Vec2 pixel) const {
  return view.gain *
         scene::vignetting(scene.appearance.vignetting_falloff, view.camera.width_px(), view.camera.height_px(), pixel);
}

std::vector<std::string> PathSetting::light_planes() const {
  if (!transport.per_light) return {};
  std::vector<std::string> names;
  for (const std::size_t light : view.lights) names.push_back("light." + scene.appearance.lights[light].id);
  if (scene.appearance.ambient) names.push_back(mechanism::light_ambient().id);
  return names;
}

Rgb PathSetting::clear(const SurfacePoint* from, Vec3 origin_m, const Inside& inside, Vec3 direction,
                       double distance_m) const {
  if (media.any()) return media.clear(from, origin_m, inside, direction, distance_m);
  const bool dark =
      from ? caster.occluded(*from, direction, distance_m) : caster.blocked(origin_m, direction, distance_m);
  return dark ? Rgb{} : Rgb{1, 1, 1};
}

PixelGeometry PathSetting::geometry(int x, int y, const Noticed& noticed) const {
  PixelGeometry geometry;
  geometry.distance_m.resize(named);
  geometry.visibility.resize(named);
  for (std::size_t i = 0; i < named && noticed.met > 0; ++i)
    geometry.visibility[i] = static_cast<double>(noticed.seen[i]) / noticed.met;
  const auto [origin_m, direction] = rays.principal({static_cast<double>(x), static_cast<double>(y)});
  const auto point = caster.closest(origin_m, direction);
  if (!point) return geometry;
  geometry.position_m = point->position_m;
  geometry.normal = point->normal;
  geometry.id = static_cast<int>(point->instance) + 1;
  for (std::size_t i = 0; i < named; ++i) {
    const light::Sample sample = emitters[i]->sample(point->position_m, {0, 0});
    if (sample.valid && std::isfinite(sample.distance_m)) geometry.distance_m[i] = sample.distance_m;
  }
  return geometry;
}

}  // namespace gonio::render
