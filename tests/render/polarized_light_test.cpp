// Polarized light in whole scenes: liquid crystal screens behind glass and reflected by it, the mosaic of a
// polarization camera, and matter in equilibrium with unpolarized radiation.
#include <gtest/gtest.h>

#include <cmath>

#include "polarized_forms.h"
#include "polarized_scenes.h"
#include "render/mosaic.h"

namespace gonio::tests {
namespace {

// A uniform screen of radiance one that faces along `normal`. Angles of its field count from +y, which must lie in the
// screen, counter-clockwise for who looks at it.
std::shared_ptr<const light::Emitter> screen(Vec3 position_m, Vec3 normal, double angle, double degree) {
  const auto vector = [](Vec3 v) { return manifest::Parameter(std::vector<double>{v.x, v.y, v.z}); };
  auto white = std::make_shared<io::Image>(2, 2, std::vector<std::string>{"Y"});
  for (float& v : white->data) v = 1;
  return light::find("screen")->prepare({{"position_m", vector(position_m)},
                                         {"direction", vector(normal)},
                                         {"up", vector(cross(normal, {0, 1, 0}))},
                                         {"width_m", 10.0},
                                         {"height_m", 10.0},
                                         {"polarization_rad", angle},
                                         {"polarization_degree", degree}},
                                        {white, {}}, "test");
}

Stokes of_screen(double angle, double degree) {
  return {{1, degree * std::cos(2 * angle), degree * std::sin(2 * angle), 0}};
}

TEST(Screens, SeenDirectly) {
  for (const double angle : {0.0, 0.4, pi / 4, 2.0}) {
    scene::Scene scene;
    scene.views = {slanted_view(0)};
    add_emitter(scene, screen({0, 0, 0}, {0, 0, 1}, angle, 0.9));
    expect_near(all_paths(scene), of_screen(angle, 0.9));
    const StokesEstimate found = stokes_of(scene, 16);
    expect_near({found.mean}, of_screen(angle, 0.9), 1e-12);
  }
}

// Through a tilted plate, and mirrored by a block that is black inside; at the second angle, Brewster's, the block
// mirrors nothing of a screen that is polarized in the plane of incidence.
TEST(Screens, SeenThroughGlassAndMirroredByIt) {
  const double eta = 1.5;
  const manifest::Parameters clear{{"eta", eta}, {"alpha", 0.0}};
  const manifest::Parameters black{{"eta", eta}, {"alpha", 0.0}, {"sigma_a_per_m", 100.0}};
  for (const double tilt : {0.5, std::atan(eta), 1.2})
    for (const double angle : {0.0, 0.6, pi / 4, pi / 2}) {
      const Vec3 away{-std::sin(tilt), 0, -std::cos(tilt)}, mirrored{away.x, 0, -away.z};
      const Stokes in = of_screen(angle, 0.95);
      scene::Scene through = plate("dielectric", clear, tilt, {0, 0, 1}, natural);
      add_emitter(through, screen(away * 40, -away, angle, 0.95));
      const Plate glass(tilt, eta, 1);
      expect_near(all_paths(through), element(glass.ts, glass.tp, glass.cross_t, in));
      scene::Scene mirror = plate("dielectric", black, tilt, {0, 0, 1}, natural);
      add_emitter(mirror, screen(mirrored * 40, -mirrored, angle, 0.95));
      const Interface face(tilt, eta);
      expect_near(all_paths(mirror), element(face.rs(), face.rp(), face.s * face.p, in));
    }
}

// A polarization camera before a screen reads Malus's law, and its four readings are the picture's s0, s1 and s2.
TEST(Screens, BeforeAPolarizationCamera) {
  for (const double angle : {0.0, 0.4, 1.0, pi / 2}) {
    SceneBuilder builder;
    builder.look_down(0, 0, 1, 4);
    scene::Scene scene = builder.scene();
    // The picture's x axis is +x here.
    scene.views.front().world_from_camera = slanted_view(0).world_from_camera;
    add_emitter(scene, screen({0, 0, 0}, {0, 0, 1}, angle, 1));
    const io::Image picture = render_view(scene, {.spp = 4, .transport = {.stokes = true}});
    const io::Image raw = render::polarizer_mosaic(picture);
    const auto malus = [&](double axis) { return std::pow(std::cos(angle - axis), 2); };
    const float i90 = raw.at(2, 2, 1), i45 = raw.at(3, 2, 1), i135 = raw.at(2, 3, 1), i0 = raw.at(3, 3, 1);
    EXPECT_NEAR(i90, malus(pi / 2), 1e-6);
    EXPECT_NEAR(i45, malus(pi / 4), 1e-6);
    EXPECT_NEAR(i135, malus(3 * pi / 4), 1e-6);
    EXPECT_NEAR(i0, malus(0), 1e-6);
    const auto plane = [&](const char* channel) { return picture.at(2, 2, picture.channel(channel)); };
    EXPECT_NEAR((i0 + i45 + i90 + i135) / 2, plane("G"), 1e-6);
    EXPECT_NEAR(i0 - i90, plane("s1.G"), 1e-6);
    EXPECT_NEAR(i45 - i135, plane("s2.G"), 1e-6);
    EXPECT_NEAR(plane("s3.G"), 0, 1e-6);
  }
}

// In uniform unpolarized radiation nothing that returns all light can be seen (Kirchhoff): what it polarizes by
// reflecting, it polarizes the other way by letting through.
class Equilibrium : public testing::Test {
 protected:
  struct Everywhere final : light::Emitter {
    light::Sample sample(Vec3, Vec2) const override { return {}; }
    light::Hit hit(Vec3, Vec3) const override { return {.radiance = {1, 1, 1}}; }
    bool infinite() const override { return true; }
  };
  // A ball, seen where light falls in at this angle.
  static scene::Scene ball(const std::string& model, const manifest::Parameters& parameters, double angle,
                           bool over_white = false) {
    SceneBuilder builder;
    const std::size_t white = builder.diffuse(1);
    const std::size_t surface = builder.surface(model, parameters);
    builder.object(scene::Sphere{1}, surface);
    scene::Scene scene = builder.scene();
    if (over_white) scene.appearance.surfaces[surface].base = white;
    scene.views = {one_pixel({std::sin(angle), 0, 5}, {0, 0, -1}, normalized(Vec3{1, 1, 0}))};
    add_emitter(scene, std::make_shared<Everywhere>());
    return scene;
  }
};

TEST_F(Equilibrium, BallOfGlass) {
  for (const double angle : {0.3, 0.98, 1.4})
    expect_near(all_paths(ball("dielectric", {{"eta", 1.5}, {"alpha", 0.0}}, angle)), natural);
}

TEST_F(Equilibrium, WhiteUnderASmoothInterface) {
  for (const double angle : {0.3, 0.98, 1.4}) {
    expect_estimates(ball("interfaced-diffuse", {{"albedo", 1.0}, {"eta", 1.5}, {"alpha", 0.0}}, angle), 1 << 13,
                     natural);
    const StokesEstimate coat = stokes_of(ball("rough-coat", {{"eta", 1.5}, {"alpha", 0.0}}, angle, true), 1 << 13);
    for (std::size_t i = 0; i < 4; ++i)  // its own error: a fixed sample of the base
      EXPECT_NEAR(coat.mean[i], natural.s[i], 4.5 * coat.sigma[i] + (i == 0 ? 0.01 : 0.002)) << i;
  }
}

// Facets see each other, and light of several facets is taken as unpolarized: that error stays small.
TEST_F(Equilibrium, BallOfFrostedGlass) {
  for (const double angle : {0.3, 0.98}) {
    const StokesEstimate found = stokes_of(ball("dielectric", {{"eta", 1.5}, {"alpha", 0.2}}, angle), 1 << 14);
    for (std::size_t i = 0; i < 4; ++i) EXPECT_NEAR(found.mean[i], natural.s[i], 4.5 * found.sigma[i] + 0.005) << i;
  }
}

// One scattering between an unpolarized lamp and the camera: s0 is what the unpolarized renderer finds, to the last
// digits, whatever the surface.
TEST(PolarizedRendering, RadianceOfOneScatteringIsTheUnpolarizedOne) {
  const manifest::Parameters interfaced{{"albedo", 0.5}, {"eta", 1.5}, {"alpha", 0.2}},
      metal{{"f0", 0.7}, {"alpha", 0.3}};
  const std::vector<std::pair<std::string, manifest::Parameters>> surfaces = {
      {"interfaced-diffuse", interfaced},
      {"metal", metal},
      {"conductor", {{"eta", 0.3}, {"k", 2.8}, {"alpha", 0.3}}},
      {"ridged", {{"ridge_rad", 0.1}, {"alpha_u", 0.4}, {"alpha_v", 0.4}, {"rho_d", 0.3}}},
      {"rough-coat", {{"eta", 1.4}, {"alpha", 0.2}}}};
  for (const auto& [model, parameters] : surfaces) {
    SceneBuilder builder;
    const std::size_t base = builder.surface("metal", metal), surface = builder.surface(model, parameters);
    builder.object(scene::Sphere{0.5}, surface);
    builder.light(
        "sphere",
        {{"position_m", manifest::Parameter(std::vector<double>{-2, 1, 3})}, {"radius_m", 0.2}, {"watt_per_sr", 10.0}});
    builder.look_down(-0.2, 0.1, 0.1, 1);
    scene::Scene scene = builder.scene();
    if (model == "rough-coat") scene.appearance.surfaces[surface].base = base;
    const StokesEstimate with = stokes_of(scene, 1 << 9, true, 1), without = stokes_of(scene, 1 << 9, false, 1);
    EXPECT_GT(without.mean[0], 0) << model;
    EXPECT_NEAR(with.mean[0], without.mean[0], 1e-12 * without.mean[0]) << model;
    EXPECT_GT(std::hypot(with.mean[1], with.mean[2]), 1e-3 * with.mean[0]) << model;
  }
}

}  // namespace
}  // namespace gonio::tests
