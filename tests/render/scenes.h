// Small scenes for the renderer's tests, built directly (no manifest).
#pragma once
#include <map>
#include <string>
#include <vector>

#include "render/path_tracer.h"
#include "scene/scene.h"

namespace gonio::tests {

class SceneBuilder {
 public:
  std::size_t surface(const std::string& model, const manifest::Parameters& parameters) {
    scene::Surface surface;
    surface.id = "s" + std::to_string(scene_.appearance.surfaces.size());
    surface.model = surface::find(model);
    surface.parameters = parameters;
    scene::refresh(surface, "test");
    scene_.appearance.surfaces.push_back(surface);
    return scene_.appearance.surfaces.size() - 1;
  }
  std::size_t diffuse(double albedo) { return surface("diffuse", {{"albedo", albedo}}); }

  SceneBuilder& light(const std::string& model, const manifest::Parameters& parameters,
                      std::shared_ptr<const io::Image> picture = {}) {
    scene::Light light;
    light.id = "l" + std::to_string(scene_.appearance.lights.size());
    light.model = light::find(model);
    light.parameters = parameters;
    light.picture = std::move(picture);
    scene::refresh(light, "test");
    scene_.appearance.lights.push_back(light);
    return *this;
  }
  SceneBuilder& object(scene::Shape shape, std::size_t surface, Vec3 translation_m = {}, Vec3 rotation_vector = {}) {
    scene_.instances.push_back({"o" + std::to_string(scene_.instances.size()),
                                std::move(shape),
                                {quaternion_of_rotation_vector(rotation_vector), translation_m},
                                surface});
    return *this;
  }
  SceneBuilder& view(const camera::CameraModel& camera, Vec3 position_m, Vec3 rotation_vector) {
    std::vector<std::size_t> lights;
    for (std::size_t i = 0; i < scene_.appearance.lights.size(); ++i) lights.push_back(i);
    scene_.views.push_back({"view",
                            camera,
                            {quaternion_of_rotation_vector(rotation_vector), position_m},
                            lights,
                            {1, 1, 1},
                            {},
                            "camera"});
    return *this;
  }
  // Looks down at the point (x, y, 0) from `height_m`; the picture spans `extent_m`.
  SceneBuilder& look_down(double x, double y, double extent_m, int size_px = 8, double height_m = 5) {
    return view(camera::CameraModel::parallel(size_px / extent_m, size_px, size_px), {x, y, height_m}, {pi, 0, 0});
  }
  scene::Scene scene() const { return scene_; }

 private:
  scene::Scene scene_;
};

inline camera::Intrinsics pinhole_lens(int size_px, double focal_px) {
  const double centre_px = (size_px - 1) / 2.0;
  return {focal_px, focal_px, centre_px, centre_px, {}};
}
inline camera::CameraModel pinhole(int size_px, double focal_px) {
  return {pinhole_lens(size_px, focal_px), size_px, size_px};
}

inline io::Image render_view(const scene::Scene& scene, const render::Options& options) {
  const render::RayCaster caster(scene.instances);
  return render::render(scene, 0, caster, options);
}

struct MeanAndError {
  double mean = 0, sigma = 0;  // of the red channel over the picture, and one standard deviation of it
};
inline MeanAndError mean_of(const io::Image& image) {
  MeanAndError result;
  const int value = image.channel("R"), variance = image.channel("variance.R");
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      result.mean += image.at(x, y, value);
      result.sigma += image.at(x, y, variance);
    }
  const auto count = static_cast<double>(image.pixels());
  result.mean /= count;
  result.sigma = std::sqrt(result.sigma) / count;
  return result;
}

// A closed latitude-longitude triangle mesh of the unit-radius sphere scaled to `radius_m`.
inline io::TriangleMesh globe(double radius_m, int rings, int sectors) {
  io::TriangleMesh mesh;
  const auto vertex = [&](int ring, int sector) {
    const double theta = pi * ring / rings, phi = 2 * pi * sector / sectors;
    return Vec3{std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)} * radius_m;
  };
  mesh.positions_m.push_back({0, 0, radius_m});
  for (int ring = 1; ring < rings; ++ring)
    for (int sector = 0; sector < sectors; ++sector) mesh.positions_m.push_back(vertex(ring, sector));
  mesh.positions_m.push_back({0, 0, -radius_m});
  const auto index = [&](int ring, int sector) {
    return static_cast<std::uint32_t>(ring == 0       ? 0
                                      : ring == rings ? 1 + (rings - 1) * sectors
                                                      : 1 + (ring - 1) * sectors + sector % sectors);
  };
  for (int ring = 0; ring < rings; ++ring)
    for (int sector = 0; sector < sectors; ++sector) {
      const std::uint32_t a = index(ring, sector), b = index(ring + 1, sector), c = index(ring + 1, sector + 1),
                          d = index(ring, sector + 1);
      if (ring + 1 < rings) mesh.triangles.push_back({a, b, c});
      if (ring > 0) mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

}  // namespace gonio::tests
