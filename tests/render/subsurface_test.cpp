// Light beneath surfaces, rendered, against closed forms and quadratures. |z| < 4.5: false alarms 7e-6 each.
#include <gtest/gtest.h>

#include "render/subsurface_walk.h"
#include "scenes.h"
#include "surface/dipole_model.h"
#include "surface/subsurface_photons.h"

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

// Mean of 1 - F over diffuse light.
double passes_mean(double eta) {
  double sum = 0;
  constexpr int n = 20000;
  for (int i = 0; i < n; ++i) {
    const double c = (i + 0.5) / n;
    sum += 2 * c / n * (1 - surface::fresnel_dielectric(c, eta));
  }
  return sum;
}

// A pencil of light on a plane, seen from above at growing distances: Jensen et al. 2001, equation 4, averaged over the
// pencil's foot.
TEST(Subsurface, RadialProfileOfAPencilOfLight) {
  const double eta = 1.3, sigma_a = 10, sigma_s = 1000, height = 1, spread = 1e-3;
  SceneBuilder pencil;
  pencil.object(scene::Plane{2, 2}, pencil.surface("dipole", medium(0, sigma_a, sigma_s, eta)));
  pencil.light("spot", {{"position_m", std::vector<double>{0, 0, height}},
                        {"direction", std::vector<double>{0, 0, -1}},
                        {"watt_per_sr", 1.0},
                        {"outer_rad", spread},
                        {"inner_share", 1.0}});
  const double total = sigma_a + sigma_s, d = 1 / (3 * total), s = std::sqrt(sigma_a / d), passes = passes_mean(eta);
  const double inside = 1 - passes / (eta * eta), zr = 1 / total, zv = zr + 4 * d * (1 + inside) / (1 - inside);
  const auto profile = [&](double square) {
    double sum = 0;
    for (const double z : {zr, zv}) {
      const double way = std::sqrt(square + z * z);
      sum += z * (1 + s * way) * std::exp(-s * way) / (way * way * way);
    }
    return sigma_s / total / (4 * pi) * sum;
  };
  const double normal = 1 - (eta - 1) * (eta - 1) / ((eta + 1) * (eta + 1)), foot_m = height * std::tan(spread);
  for (const double distance_m : {0.002, 0.004, 0.006}) {
    double mean = 0;
    constexpr int radii = 40, angles = 40;
    for (int i = 0; i < radii; ++i)
      for (int k = 0; k < angles; ++k) {
        const double r = foot_m * std::sqrt((i + 0.5) / radii), phi = 2 * pi * (k + 0.5) / angles;
        const double x = distance_m - r * std::cos(phi), y = r * std::sin(phi);
        mean += profile(x * x + y * y) / (radii * angles);
      }
    const double truth = normal * normal * mean * pi * foot_m * foot_m / (pi * passes);
    SceneBuilder here = pencil;
    const MeanAndError found = mean_of(render_view(here.look_down(distance_m, 0, 1e-9).scene(), {.spp = 3072}));
    EXPECT_LT(found.sigma, 0.05 * truth) << distance_m;
    expect_value(found, truth, 2 * left_out);
  }
}

// Paths through the medium itself, without diffusion theory: the same half space by photons of another program.
TEST(Subsurface, MediumOfAHalfSpaceAgreesWithPhotons) {
  for (const double g : {0.0, 0.6}) {
    SceneBuilder builder;
    auto parameters = medium(0, 100, 900 / (1 - g), 1.4);
    parameters["g"] = g;
    builder.object(scene::Plane{200, 200}, builder.surface("dielectric", parameters));
    builder.light("uniform", {{"radiance", 1.0}});
    const MeanAndError found = mean_of(render_view(builder.look_down(0, 0, 0.1).scene(), {.spp = 768}));
    tests::Photons photons({100, 900 / (1 - g), g, 1.4}, 12);
    double sum = 0, squares = 0;
    constexpr int count = 40000;
    for (int i = 0; i < count; ++i) {
      const double weight = photons.trace({0, 0, -1}).weight;
      sum += weight / count;
      squares += weight * weight / count;
    }
    const double reflects = 0.4 * 0.4 / (2.4 * 2.4), truth = reflects + (1 - reflects) * sum;
    const double error = std::hypot(found.sigma, (1 - reflects) * std::sqrt((squares - sum * sum) / count));
    EXPECT_LT(error, 0.01 * truth);
    EXPECT_NEAR(found.mean, truth, z_limit * error) << g;
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

// Entries weigh what they stand for: summed up they are the body's area, as much above as below.
TEST(Subsurface, EntriesCoverTheBody) {
  const double radius_m = 0.002;
  const auto mesh =
      std::make_shared<const mesh::Mesh>(mesh::prepare(tests::globe(radius_m, 24, 48), mesh::Shading::smooth, "globe"));
  for (const scene::Shape& shape : {scene::Shape(scene::Sphere{radius_m}), scene::Shape(mesh)}) {
    SceneBuilder builder;
    builder.object(shape, builder.surface("dipole", medium(0, 1, 1000)));
    const auto scene = builder.scene();
    const RayCaster caster(scene.instances);
    const auto exit = caster.closest({0.0003, 0.0002, 1}, {0, 0, -1});
    ASSERT_TRUE(exit.has_value());
    const surface::Values& values = scene.appearance.surfaces[0].values;
    const auto* beneath = scene.appearance.surfaces[0].model->subsurface(values);
    ASSERT_GT(beneath->reach_m(), 2 * radius_m);
    double area = 0, squares = 0, height = 0, height_squares = 0;
    constexpr std::uint32_t count = 1 << 17;
    for (std::uint32_t i = 0; i < count; ++i) {
      Sampler sampler(3, i, 0);
      const auto entry = draw_entry(caster, *beneath, *exit, sampler);
      if (!entry) continue;
      EXPECT_TRUE(entry->point.outside);
      const double weight = entry->per_area, moment = weight * entry->point.position_m.z;
      area += weight / count;
      squares += weight * weight / count;
      height += moment / count;
      height_squares += moment * moment / count;
    }
    const double error = std::sqrt((squares - area * area) / count);
    const double truth = shape.index() == 0 ? 4 * pi * radius_m * radius_m : mesh::area_m2(*mesh);
    EXPECT_LT(error, 0.01 * truth);
    EXPECT_NEAR(area, truth, z_limit * error);
    EXPECT_NEAR(height, 0, z_limit * std::sqrt(height_squares / count));
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
