// Cached geometry predicts what the path tracer renders, for any albedos, without new rays.
#include "render/geometry_cache.h"

#include <gtest/gtest.h>

#include <set>

#include "light/irradiance.h"
#include "scenes.h"

namespace gonio::render {
namespace {

using tests::pinhole;
using tests::SceneBuilder;

TEST(Monomials, EachMultisetOnce) {
  for (const std::size_t surfaces : {1u, 2u, 4u}) {
    const Monomials monomials(surfaces, 5);
    std::set<std::vector<std::uint8_t>> seen;
    for (std::size_t m = 0; m < monomials.size(); ++m)
      seen.emplace(monomials.exponents(m).begin(), monomials.exponents(m).end());
    EXPECT_EQ(seen.size(), monomials.size());
    // (surfaces + degree) choose degree
    EXPECT_EQ(monomials.size(), surfaces == 1 ? 6u : surfaces == 2 ? 21u : 126u);
  }
}

TEST(Monomials, EvaluateAsProducts) {
  const Monomials monomials(3, 4);
  const std::vector<double> albedos = {0.2, 0.5, 0.9};
  const std::vector<double> values = monomials.evaluate(albedos);
  for (std::size_t m = 0; m < monomials.size(); ++m) {
    double product = 1;
    for (std::size_t s = 0; s < 3; ++s) product *= std::pow(albedos[s], monomials.exponents(m)[s]);
    EXPECT_NEAR(values[m], product, 1e-15);
  }
}

TEST(Received, PenumbraOfASphereLight) {
  SceneBuilder builder;
  builder.object(scene::Plane{4, 4}, builder.diffuse(0.5));
  builder.object(scene::Plane{1, 4}, 0, {-0.5, 0, 0.25});  // covers x < 0
  builder.light("sphere", {{"position_m", std::vector<double>{0, 0, 0.5}}, {"watt_per_sr", 1.0}, {"radius_m", 0.02}});
  const auto scene = builder.scene();
  const RayCaster caster(scene.instances);
  const auto& lamp = *scene.appearance.lights[0].emitter;
  const auto at = [&](double x) { return *caster.closest({x, 0, 0.1}, {0, 0, -1}); };
  EXPECT_EQ(received(caster, at(0.1), lamp, 256, 1).visibility, 1);
  EXPECT_EQ(received(caster, at(-0.1), lamp, 256, 1).visibility, 0);
  EXPECT_NEAR(received(caster, at(0), lamp, 256, 1).visibility, 0.5, 0.03);  // the shadow's edge halves the lamp
  const Rgb truth = light::sphere_irradiance({1, 1, 1}, {0, 0, 0.5}, 0.02, {0.1, 0, 0}, {0, 0, 1});
  EXPECT_NEAR(received(caster, at(0.1), lamp, 64, 1).irradiance.x, truth.x, 1e-3 * truth.x);
}

scene::Scene corner(double floor, double ball) {
  SceneBuilder builder;
  builder.object(scene::Plane{0.5, 0.5}, builder.diffuse(floor));
  builder.object(scene::Sphere{0.1}, builder.diffuse(ball), {0, 0, 0.12});
  builder.light("point", {{"position_m", std::vector<double>{0.3, -0.1, 0.4}}, {"watt_per_sr", 1.0}});
  builder.light("uniform", {{"radiance", 0.5}});
  return builder.view(pinhole(16, 18), {0, -0.4, 0.5}, {-2.4, 0, 0}).scene();
}

// One cache serves three pairs of albedos; means over the picture agree with path tracing within both errors (|z| < 4.5
// with the path tracer's variance, and 1 % of the indirect part for the cache's own noise).
TEST(IndirectIrradiance, PredictsPathTracingForAnyAlbedos) {
  const auto base = corner(0.5, 0.5);
  const RayCaster caster(base.instances);
  constexpr int side = 8;
  const auto views = view_points(caster, base.views[0], side);
  std::vector<SurfacePoint> points;
  for (const ViewPoint& v : views)
    if (v.found) points.push_back(v.point);
  const std::vector<const light::Emitter*> emitters = {base.appearance.lights[0].emitter.get(),
                                                       base.appearance.lights[1].emitter.get()};
  const auto indirect = indirect_irradiance(caster, 2, points, emitters, {.bounces = 8, .paths = 16});
  for (const auto& [floor, ball] : {std::pair{0.5, 0.5}, std::pair{0.9, 0.2}, std::pair{0.1, 0.8}}) {
    const auto scene = corner(floor, ball);
    const std::vector<double> albedos = {floor, ball}, factors = indirect.monomials.evaluate(albedos);
    double predicted = 0, share = 0, background = 0;
    for (const ViewPoint& v : views) background += v.found ? 0 : 0.5;
    for (std::size_t i = 0; i < points.size(); ++i) {
      double more = 0;
      for (std::size_t source = 0; source < 2; ++source)
        for (std::size_t m = 0; m < factors.size(); ++m) more += factors[m] * indirect.at(i, source)[m];
      const double direct = received(caster, points[i], *emitters[0], 1, 1).irradiance.x;
      predicted += albedos[points[i].surface] / pi * (direct + more);
      share += albedos[points[i].surface] / pi * more;
    }
    const auto count = static_cast<double>(views.size());
    const auto rendered = tests::mean_of(render(scene, 0, caster, {.spp = 1024}));
    EXPECT_NEAR((predicted + background) / count, rendered.mean,
                4.5 * rendered.sigma + 0.01 * share / count + 1e-3 * rendered.mean);
  }
}

TEST(IndirectIrradiance, LampsHaveNoConstantTermAndEnvironmentsDo) {
  const auto scene = corner(0.5, 0.5);
  const RayCaster caster(scene.instances);
  const auto point = *caster.closest({0.2, 0.2, 1}, {0, 0, -1});
  const std::vector<const light::Emitter*> emitters = {scene.appearance.lights[0].emitter.get(),
                                                       scene.appearance.lights[1].emitter.get()};
  const auto indirect = indirect_irradiance(caster, 2, std::vector{point}, emitters, {.bounces = 3, .paths = 256});
  EXPECT_EQ(indirect.at(0, 0)[0], 0);
  EXPECT_LT(indirect.at(0, 1)[0], pi * 0.5);
  EXPECT_GT(indirect.at(0, 1)[0], 0.8 * pi * 0.5);  // the ball hides a little
  // A plane cannot see itself: no term begins on the floor.
  EXPECT_EQ(indirect.at(0, 0)[1], 0);
  EXPECT_GT(indirect.at(0, 0)[2], 0);
}

TEST(ViewPoints, LieOnThePixelsTheyBelongTo) {
  const auto scene = corner(0.5, 0.5);
  const RayCaster caster(scene.instances);
  const auto& view = scene.views[0];
  const auto points = view_points(caster, view, 3);
  const auto camera_from_world = inverse(view.world_from_camera);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].found) continue;
    const auto pixel = view.camera.project(camera_from_world * points[i].point.position_m);
    ASSERT_TRUE(pixel);
    const std::size_t owner = i / 9, cell = i % 9;
    EXPECT_NEAR(pixel->x, static_cast<double>(owner % 16) - 0.5 + (cell % 3 + 0.5) / 3, 1e-6);
    EXPECT_NEAR(pixel->y, static_cast<double>(owner / 16) - 0.5 + (cell / 3 + 0.5) / 3, 1e-6);
  }
}

}  // namespace
}  // namespace gonio::render
