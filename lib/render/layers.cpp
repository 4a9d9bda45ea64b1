#include "render/layers.h"

#include <algorithm>

#include "base/parallel.h"

namespace gonio::render {
namespace {

bool lets_light_through(const scene::Scene& scene, std::size_t surface) {
  return scene.appearance.surfaces[surface].model->transmits();
}

Vec3 back_normal(const scene::Scene& scene, const scene::View& view, const RayCaster& caster, Vec2 pixel, int id) {
  if (id == 0) return {};
  const auto instance = static_cast<std::uint32_t>(id - 1);
  if (!lets_light_through(scene, scene.instances[instance].surface)) return {};
  const camera::Ray ray = view.camera.ray(pixel);
  const auto all = caster.crossings(instance, view.world_from_camera * ray.origin_m,
                                    view.world_from_camera.rotate(ray.direction), far_away);
  if (all.empty()) return {};
  return all.back().outside ? all.back().normal : -all.back().normal;
}

}  // namespace

io::Image geometry_layers(const scene::Scene& scene, std::size_t view_place, const RayCaster& caster,
                          const Integrator& integrator) {
  const scene::View& view = scene.views[view_place];
  const bool with_back = std::ranges::any_of(
      scene.instances, [&](const scene::Instance& instance) { return lets_light_through(scene, instance.surface); });
  std::vector<std::string> names = {"id", "position.X", "position.Y", "position.Z", "normal.X", "normal.Y", "normal.Z"};
  for (const std::size_t light : view.lights) names.push_back("distance." + scene.appearance.lights[light].id);
  names.push_back("depth.Z");
  if (with_back) names.insert(names.end(), {"back_normal.X", "back_normal.Y", "back_normal.Z"});
  io::Image image(view.camera.width_px(), view.camera.height_px(), names);
  const auto camera_from_world = inverse(view.world_from_camera);
  const Noticed nothing{.seen = std::vector<std::uint32_t>(integrator.lights()), .met = 0};
  parallel_for(0, static_cast<std::size_t>(image.height), [&](std::size_t row) {
    float* out = image.data.data() + row * static_cast<std::size_t>(image.width) * names.size();
    const auto put = [&](double v) { *out++ = static_cast<float>(v); };
    const auto put_vector = [&](Vec3 v) { put(v.x), put(v.y), put(v.z); };
    for (int x = 0; x < image.width; ++x) {
      const PixelGeometry pixel = integrator.geometry(x, static_cast<int>(row), nothing);
      put(pixel.id);
      put_vector(pixel.position_m);
      put_vector(pixel.normal);
      for (std::size_t i = 0; i < view.lights.size(); ++i) put(pixel.distance_m[i]);
      put(pixel.id == 0 ? 0 : (camera_from_world * pixel.position_m).z);
      const Vec2 centre{static_cast<double>(x), static_cast<double>(row)};
      if (with_back) put_vector(back_normal(scene, view, caster, centre, pixel.id));
    }
  });
  return image;
}

}  // namespace gonio::render
