// Blender itself, where it is installed: the exported scene rendered by Cycles has the radiances of closed forms.
#include <cmath>

#include "exchange_cases.h"
#include "manifest/image_list.h"
#include "manifest/sections/light.h"
#include "process.h"

namespace gonio::scene {
namespace {

bool blender_is_here() {
  return std::system("command -v blender > /dev/null 2>&1") == 0;
}

io::Image rendered(const Letter& letter, const std::string& image, int spp) {
  const std::filesystem::path folder = letter.folder() / "blender";
  for (const ExchangedFile& file : letter.exported("blender").files) {
    make_folder((folder / file.name).parent_path());
    write_file(folder / file.name, file.content);
  }
  const tests::Ended ended =
      tests::Process({"blender", "-b", "--factory-startup", "-noaudio", "-P", (folder / "scene.py").string(), "--",
                      "--image", image, "--spp", std::to_string(spp), "--threads", "1", "--out",
                      (folder / "x.exr").string()})
          .end();
  EXPECT_EQ(ended.status, 0) << ended.err;
  EXPECT_THAT(ended.out, testing::ContainsRegex("render_seconds [0-9]+\\."));
  return io::read_picture(folder / "x.exr");
}

// Radiance of the nearest plate or table along a ray, by Lambert's law under one unshadowed light; nothing for rays
// that meet a ball or pass near an edge or a shadow.
struct Seen {
  bool sure = false;
  Rgb radiance;
};
template <class Irradiance>
Seen seen(const Scene& scene, const View& view, Vec2 pixel, const Irradiance& irradiance) {
  const camera::Ray ray = view.camera.ray(pixel);
  const Vec3 o = view.world_from_camera * ray.origin_m, d = view.world_from_camera.rotate(ray.direction);
  Seen best;
  double nearest = 1e9;
  for (const Instance& instance : scene.instances) {
    const Vec3 centre = instance.world_from_object.translation_m;
    const auto* plane = std::get_if<Plane>(&instance.shape);
    if (!plane) continue;
    const double t = (centre.z - o.z) / d.z;
    const Vec3 p = o + d * t, arm = p - centre;
    const double over_x = std::abs(arm.x) / plane->size_x_m, over_y = std::abs(arm.y) / plane->size_y_m;
    if (t >= nearest || over_x > 0.5 || over_y > 0.5) continue;
    nearest = t;
    best.sure = centre.z > 0 && over_x < 0.3 && over_y < 0.3;  // plates only: the table lies in their shadow
    best.radiance = scene.appearance.surfaces[instance.surface].values.rgb(0) * irradiance(p) * (1 / pi);
  }
  return best;
}

template <class Irradiance>
void expect_radiances(std::size_t image, const Irradiance& irradiance) {
  Letter letter;
  letter.enlarge_without_balls();
  const View& view = letter.scene.views[image];
  const io::Image picture = rendered(letter, view.image, 32);
  ASSERT_EQ(picture.width, 192);
  int sure = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto at = [&](double dx, double dy) { return seen(letter.scene, view, {x + dx, y + dy}, irradiance); };
      const bool whole = at(-1, -1).sure && at(1, -1).sure && at(-1, 1).sure && at(1, 1).sure;
      const Seen here = at(0, 0);
      if (!whole || !here.sure) continue;
      ++sure;
      for (int c = 0; c < 3; ++c)
        EXPECT_NEAR(picture.at(x, y, c) / (here.radiance[c] * view.gain[c]), 1, 1e-3) << x << " " << y << " " << c;
    }
  EXPECT_GT(sure, 150);
}

TEST(ExchangeBlender, PointLampAndGain) {
  if (!blender_is_here()) GTEST_SKIP() << "blender is not installed";
  expect_radiances(0, [](Vec3 p) {
    const Vec3 arm = Vec3{0.4, -0.3, 0.9} - p;
    return Rgb{1, 2, 3} * (arm.z / std::pow(norm(arm), 3));
  });
}

TEST(ExchangeBlender, SunAndOrthographicCamera) {
  if (!blender_is_here()) GTEST_SKIP() << "blender is not installed";
  expect_radiances(1, [](Vec3) { return Rgb{3, 2, 1} * (1 / norm(Vec3{0.3, 0.2, 1})); });
}

// Irradiance of a plate that faces up, by a lattice of the lamp's own samples.
Rgb irradiance(const light::Emitter& lamp, Vec3 p) {
  constexpr int side = 24;
  Rgb sum;
  for (int i = 0; i < side * side; ++i) {
    const light::Sample s = lamp.sample(p, {(i % side + 0.5) / side, (i / side + 0.5) / side});
    if (s.valid && s.direction.z > 0) sum += s.weight * (s.direction.z / (s.delta ? 1 : side * side));
    if (s.delta) return sum;
  }
  return sum;
}

// The mean over the plates; lamps with an extent leave noise in single pixels.
TEST(ExchangeBlender, LampsThatFaceSomewhere) {
  if (!blender_is_here()) GTEST_SKIP() << "blender is not installed";
  Letter letter;
  const manifest::Parameter at(std::vector<double>{0.1, -0.3, 0.9}), down(std::vector<double>{-0.1, 0.3, -0.9}),
      one(1.0);
  letter.document.lights = {
      {"disc", {"disc", {{"position_m", at}, {"direction", down}, {"watt_per_sr", one}, {"radius_m", 0.1}}}},
      {"panel",
       {"rectangle",
        {{"position_m", at}, {"direction", down}, {"width_m", 0.3}, {"height_m", 0.1}, {"watt_per_sr", 0.5}}}},
      {"stage",
       {"spot",
        {{"position_m", at},
         {"direction", down},
         {"watt_per_sr", 2},
         {"outer_rad", 0.35},
         {"inner_share", 0.4},
         {"exponent", 1}}}}};
  keep_images(letter.document, {"lamp"});
  light_image(letter.document, "lamp", {"disc", "panel", "stage"});
  letter.enlarge_without_balls();
  const View& view = letter.scene.views[0];
  const io::Image picture = rendered(letter, view.image, 32);
  double found = 0, expected = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto look = [&](double dx, double dy) {
        return seen(letter.scene, view, {x + dx, y + dy}, [](Vec3) { return Rgb{1, 1, 1}; });
      };
      if (!look(-1, -1).sure || !look(1, -1).sure || !look(-1, 1).sure || !look(1, 1).sure) continue;
      const Seen here = seen(letter.scene, view, {double(x), double(y)}, [&](Vec3 p) {
        Rgb sum;
        for (const std::size_t i : view.lights) sum += irradiance(*letter.scene.appearance.lights[i].emitter, p);
        return sum;
      });
      found += picture.at(x, y, 1);
      expected += here.radiance.y * view.gain.y;
    }
  EXPECT_GT(expected, 0);
  EXPECT_NEAR(found / expected, 1, 3e-3);
}

// The camera looks into the sky: every pixel within one texel shows that texel.
TEST(ExchangeBlender, Surroundings) {
  if (!blender_is_here()) GTEST_SKIP() << "blender is not installed";
  Letter letter;
  letter.enlarge_without_balls();
  const View& view = letter.scene.views[2];
  const io::Image picture = rendered(letter, "sky", 4);
  const light::Emitter& sky = *letter.scene.appearance.lights[view.lights.at(0)].emitter;
  int sure = 0;
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const auto at = [&](double dx, double dy) {
        return sky.hit({}, view.world_from_camera.rotate(view.camera.ray({x + dx, y + dy}).direction)).radiance;
      };
      const Rgb here = at(0, 0);
      if (!(at(-0.6, -0.6) == here && at(0.6, -0.6) == here && at(-0.6, 0.6) == here && at(0.6, 0.6) == here)) continue;
      ++sure;
      for (int c = 0; c < 3; ++c) EXPECT_NEAR(picture.at(x, y, c) / here[c], 1, 1e-4) << x << " " << y << " " << c;
    }
  EXPECT_GT(sure, 150);
}

}  // namespace
}  // namespace gonio::scene
