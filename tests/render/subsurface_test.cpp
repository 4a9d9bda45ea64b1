// Light beneath surfaces, rendered, against closed forms and quadratures. |z| < 4.5: false alarms 7e-6 each.
#include <gtest/gtest.h>

#include "scenes.h"
#include "surface/dipole_model.h"

namespace gonio::render {
namespace {

using tests::mean_of;
using tests::MeanAndError;
using tests::render_view;
using tests::SceneBuilder;

constexpr double z_limit = 4.5, left_out = 1e-3;  // of the energy, beyond the reach

void expect_value(const MeanAndError& found, double truth, double relative) {
  EXPECT_NEAR(found.mean, truth, z_limit * found.sigma + relative * truth)
      << "z = " << (found.mean - truth) / found.sigma;
}
manifest::Parameters medium(double alpha, double sigma_a, double sigma_s, double eta = 1.5) {
  return {{"eta", eta}, {"alpha", alpha}, {"sigma_a_per_m", sigma_a}, {"sigma_s_per_m", sigma_s}};
}

// What uniform light makes a plane reflect: albedo(). That of the directional dipole takes directions through a smooth
// interface; rough ones spread them, by which 1 % more comes back.
TEST(Subsurface, PlaneUnderUniformLight) {
  for (const char* model : {"dipole", "directional-dipole"})
    for (const double alpha : {0.0, 0.3}) {
      const bool directional = std::string(model) != "dipole";
      SceneBuilder builder;
      builder.object(scene::Plane{200, 200}, builder.surface(model, medium(alpha, 20, 1000)));
      builder.light("uniform", {{"radiance", 1.0}});
      const auto scene = builder.look_down(0, 0, 0.5).scene();
      const auto& surface = scene.appearance.surfaces[0];
      const double truth = surface.model->albedo(surface.values, {0, 0, 1}).x;
      const MeanAndError found = mean_of(render_view(scene, {.spp = 1024}));
      EXPECT_LT(found.sigma, 0.01 * truth);
      expect_value(found, truth, directional && alpha > 0 ? 0.015 : 2 * left_out);
    }
}

// A point light over a plane, seen from above beside it: the integral of S_d T(wi) cos I / d^2 by quadrature.
TEST(Subsurface, PlaneUnderAPointLight) {
  for (const char* model : {"dipole", "directional-dipole"}) {
    SceneBuilder builder;
    builder.object(scene::Plane{2, 2}, builder.surface(model, medium(0, 100, 1000)));
    const Vec3 lamp{0, 0, 0.002}, exit{0.004, 0, 0};
    builder.light("point", {{"position_m", std::vector<double>{0, 0, 0.002}}, {"watt_per_sr", 1.0}});
    const auto scene = builder.look_down(exit.x, 0, 1e-9).scene();
    const surface::Values& values = scene.appearance.surfaces[0].values;
    const auto* beneath = scene.appearance.surfaces[0].model->subsurface(values);
    double sum = 0;
    constexpr int radii = 400, angles = 256;
    for (int i = 0; i < radii; ++i)
      for (int k = 0; k < angles; ++k) {  // about the foot of the lamp, denser there
        const double u = (i + 0.5) / radii, r = 0.03 * u * u, phi = 2 * pi * (k + 0.5) / angles;
        const Vec3 point{r * std::cos(phi), r * std::sin(phi), 0}, arm = lamp - point;
        const Vec3 wi = normalized(arm);
        const auto in = beneath->enter(values, wi, {0.5, 0.5});
        sum += beneath->evaluate({point, {0, 0, 1}, in.onwards}, exit, {0, 0, 1}).x * in.share * wi.z / dot(arm, arm) *
               r * (2 * 0.03 * u / radii) * (2 * pi / angles);
      }
    const double truth = 0.96 * sum;
    const MeanAndError found = mean_of(render_view(scene, {.spp = 4096}));
    EXPECT_LT(found.sigma, 0.01 * truth) << model;
    expect_value(found, truth, 2 * left_out);
  }
}

// A convex body does not shine more than what surrounds it.
TEST(Subsurface, FurnaceOfASphere) {
  for (const char* model : {"dipole", "directional-dipole"}) {
    SceneBuilder builder;
    builder.object(scene::Sphere{0.05}, builder.surface(model, medium(0.3, 0, 1000)));
    builder.light("uniform", {{"radiance", 1.0}});
    const auto scene = builder.look_down(0, 0, 0.08, 12).scene();
    const MeanAndError found = mean_of(render_view(scene, {.spp = 256}));
    EXPECT_LT(found.sigma, 0.01);
    EXPECT_LE(found.mean, 1 + z_limit * found.sigma) << model;
    EXPECT_GE(found.mean, 0.8) << model;
  }
}

// L = alpha p T T / eta^2 E cos_i / (cos_12 + cos_21) on a half space.
TEST(Subsurface, SingleScatteringOfAHalfSpace) {
  SceneBuilder builder;
  auto parameters = medium(0, 800, 200);
  parameters["single_scattering"] = 1.0;
  parameters["g"] = 0.4;
  builder.object(scene::Plane{1, 1}, builder.surface("dipole", parameters));
  builder.light("directional", {{"towards", std::vector<double>{3, 0, 4}}, {"watt_per_m2", 1.0}});
  const auto scene = builder.look_down(0, 0, 0.1).scene();
  const MeanAndError found = mean_of(render_view(scene, {.spp = 4096}));
  const double c = 0.8, c12 = std::sqrt(1 - 0.36 / 2.25), g = 0.4;
  const double back = 1 + g * g + 2 * g * c12, phase = (1 - g * g) / (4 * pi * back * std::sqrt(back));
  const double enters = 0.96 * (1 - surface::fresnel_dielectric(c, 1.5)) * c;
  const double once = 0.2 * phase * enters / 2.25 / (c12 + 1);
  const auto* dipole = static_cast<const surface::DipoleSubsurface*>(scene.appearance.surfaces[0].values.prepared);
  const double more = enters * dipole->diffuse_reflectance().x / (pi * dipole->interior().transmits_in);
  EXPECT_LT(found.sigma, 0.02 * once);
  expect_value(found, once + more, left_out);
}

// Without scattering the directional dipole is glass that absorbs, but for what it reflects within.
TEST(Subsurface, ReducedIntensityPassesThrough) {
  SceneBuilder builder;
  builder.object(scene::Sphere{0.05}, builder.surface("directional-dipole", medium(0, 10, 0)));
  builder.light("uniform", {{"radiance", 1.0}});
  const MeanAndError found = mean_of(render_view(builder.look_down(0, 0, 1e-6).scene(), {.spp = 1024}));
  EXPECT_LT(found.sigma, 0.01);
  expect_value(found, 0.04 + 0.96 * 0.96 * std::exp(-1), 1e-5);
}

}  // namespace
}  // namespace gonio::render
