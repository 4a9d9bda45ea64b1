// Polarization of what paths from the lights bring: where paths from the camera can find the same light, both must find
// the same Stokes vectors. |z| < 4.5: false alarm 7e-6 each; seeds are fixed.
#include <gtest/gtest.h>

#include "scenes.h"

namespace gonio::tests {
namespace {

struct Mean {
  double value = 0, sigma = 0;
};
// Of the green plane `prefix` over the picture.
Mean mean_of_plane(const io::Image& picture, const std::string& prefix) {
  const int value = picture.channel(prefix + "G"), variance = picture.channel("variance." + prefix + "G");
  Mean mean;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      mean.value += picture.at(x, y, value) / static_cast<double>(picture.pixels());
      mean.sigma += picture.at(x, y, variance);
    }
  mean.sigma = std::sqrt(mean.sigma) / static_cast<double>(picture.pixels());
  return mean;
}

// A screen above a tilted ball of glass lights a rough metal floor through it; the camera sees the floor at a slant.
scene::Scene screen_over_glass(const std::string& floor, const manifest::Parameters& parameters) {
  SceneBuilder builder;
  builder.object(scene::Sphere{0.5}, builder.surface("dielectric", {{"eta", 1.5}, {"alpha", 0.0}}), {0.4, 0, 0.8});
  builder.object(scene::Plane{6, 6}, builder.surface(floor, parameters));
  // Turned about its x axis by 120 degrees: it looks along (0, sin 120, cos 120), down at 30 degrees to the floor.
  const Vec3 forward{0, std::sin(2 * pi / 3), std::cos(2 * pi / 3)};
  builder.view(camera::CameraModel::parallel(4, 2, 2), forward * -2, {-2 * pi / 3, 0, 0});
  scene::Scene scene = builder.scene();
  scene::Light light;
  light.id = "screen";
  auto white = std::make_shared<io::Image>(1, 1, std::vector<std::string>{"Y"});
  white->data = {1};
  const auto vector = [](Vec3 v) { return manifest::Parameter(std::vector<double>{v.x, v.y, v.z}); };
  light.emitter = light::find("screen")->prepare({{"position_m", vector({1, 0.4, 2})},
                                                  {"direction", vector({-0.4, -0.3, -1})},
                                                  {"width_m", 1.5},
                                                  {"height_m", 1.5},
                                                  {"polarization_rad", 0.5}},
                                                 {white, {}}, "test");
  scene.appearance.lights.push_back(light);
  scene.views.front().lights = {0};
  return scene;
}

TEST(PolarizedPhotons, BringWhatPathsFromTheCameraFind) {
  const std::vector<std::pair<std::string, manifest::Parameters>> floors = {
      {"conductor", {{"eta", 0.3}, {"k", 2.8}, {"alpha", 0.4}}},
      {"interfaced-diffuse", {{"albedo", 0.5}, {"eta", 1.5}, {"alpha", 0.3}}}};
  for (const auto& [floor, parameters] : floors) {
    const scene::Scene scene = screen_over_glass(floor, parameters);
    const auto picture = [&](bool from_lights) {
      return render_view(scene, {.spp = 1 << 14, .transport = {.stokes = true, .from_lights = from_lights}});
    };
    const io::Image both = picture(true), camera = picture(false);
    EXPECT_GT(std::abs(mean_of_plane(both, "s1.").value), 50 * mean_of_plane(both, "s1.").sigma) << floor;
    for (const std::string plane : {"", "s1.", "s2.", "s3."}) {
      const Mean a = mean_of_plane(both, plane), b = mean_of_plane(camera, plane);
      EXPECT_NEAR(a.value, b.value, 4.5 * std::hypot(a.sigma, b.sigma)) << floor << " " << plane;
    }
  }
}

}  // namespace
}  // namespace gonio::tests
