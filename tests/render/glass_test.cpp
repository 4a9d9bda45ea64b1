// Interfaces and absorbing media against closed forms. Statistical tests: |z| < 4.5, false alarm 7e-6 each.
#include <gtest/gtest.h>

#include "scenes.h"

namespace gonio::render {
namespace {

using tests::mean_of;
using tests::MeanAndError;
using tests::pinhole;
using tests::render_view;
using tests::SceneBuilder;

constexpr double z_limit = 4.5;

void expect_value(const MeanAndError& found, double truth, double exact = 1e-6) {
  EXPECT_NEAR(found.mean, truth, z_limit * found.sigma + exact * truth) << "z = " << (found.mean - truth) / found.sigma;
}
std::vector<double> grey(double v) {
  return {v, v, v};
}
std::size_t glass(SceneBuilder& builder, double eta, double alpha = 0, double absorption = 0) {
  return builder.surface("dielectric", {{"eta", grey(eta)}, {"alpha", alpha}, {"sigma_a_per_m", grey(absorption)}});
}
// Unpolarized reflectance from air to `eta`, cosine outside (Born & Wolf 1999, section 1.5.2).
double fresnel(double cosine, double eta) {
  const double t = std::sqrt(1 - (1 - cosine * cosine) / (eta * eta));
  const double s = (cosine - eta * t) / (cosine + eta * t), p = (eta * cosine - t) / (eta * cosine + t);
  return (s * s + p * p) / 2;
}
// Radiance through a slab: all orders of reflection inside (incoherent sum). The renderer averages polarizations at
// every interface, and so does this.
double slab(double cosine, double eta, double absorption, double thickness) {
  const double f = fresnel(cosine, eta), inner = std::sqrt(1 - (1 - cosine * cosine) / (eta * eta));
  const double a = std::exp(-absorption * thickness / inner);
  return (1 - f) * (1 - f) * a / (1 - f * f * a * a);
}
// A box of triangles, flat.
std::shared_ptr<const mesh::Mesh> box(Vec3 low, Vec3 high) {
  io::TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions_m.push_back({i & 1 ? high.x : low.x, i & 2 ? high.y : low.y, i & 4 ? high.z : low.z});
  const std::array<std::array<std::uint32_t, 4>, 6> faces = {
      {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}}};
  for (const auto& f : faces) {
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
  }
  return std::make_shared<const mesh::Mesh>(mesh::prepare(mesh, mesh::Shading::flat, "box"));
}

// Whatever it is made of, what does not absorb is invisible in uniform light of radiance 1.
TEST(GlassFurnace, SmoothAndRoughObjectsVanish) {
  struct Case {
    double alpha, exact;
  };
  for (const Case c : {Case{0, 1e-6}, Case{0.1, 3e-3}, Case{0.5, 6e-3}}) {  // rough: the energy of the model's tables
    SceneBuilder builder;
    builder.object(scene::Sphere{0.1}, glass(builder, 1.5, c.alpha));
    builder.light("uniform", {{"radiance", 1.0}});
    const auto scene = builder.view(pinhole(12, 20), {0, 0, 0.4}, {pi, 0, 0}).scene();
    expect_value(mean_of(render_view(scene, {.spp = 256})), 1, c.exact);
  }
}

TEST(GlassFurnace, MeshVanishes) {
  SceneBuilder builder;
  builder.object(box({-0.1, -0.1, -0.1}, {0.1, 0.1, 0.1}), glass(builder, 1.33), {}, {0.3, 0.5, 0.2});
  builder.light("uniform", {{"radiance", 1.0}});
  const auto scene = builder.view(pinhole(12, 20), {0, 0, 0.6}, {pi, 0, 0}).scene();
  expect_value(mean_of(render_view(scene, {.spp = 256})), 1, 1e-5);
}

// Light that is scattered inside without loss comes out again: a cloudy ball is as invisible as a clear one, whether
// its surface refracts or is no interface at all; roulette, which ends long walks, leaves no bias.
TEST(GlassFurnace, CloudyBallsVanish) {
  for (const double eta : {1.0, 1.3}) {
    SceneBuilder builder;
    builder.object(scene::Sphere{0.1},
                   builder.surface("dielectric", {{"eta", eta},
                                                  {"sigma_a_per_m", grey(0)},
                                                  {"sigma_s_per_m", std::vector<double>{10, 30, 60}},
                                                  {"g", 0.4}}));
    builder.light("uniform", {{"radiance", 1.0}});
    const auto scene = builder.view(pinhole(12, 20), {0, 0, 0.4}, {pi, 0, 0}).scene();
    expect_value(mean_of(render_view(scene, {.spp = 256, .transport = {.max_bounces = 1 << 20}})), 1, 1e-5);
  }
}

TEST(Bouguer, SlabAtSeveralAngles) {
  for (const double angle : {0.0, 0.6, 1.2}) {
    SceneBuilder builder;
    // Wide enough that no order of reflection leaves through its sides. Below it a black plane, above it light that
    // only transmitted paths reach: the environment below the horizon.
    builder.object(box({-5, -5, -0.01}, {5, 5, 0.01}), glass(builder, 1.5, 0, 40));
    builder.object(scene::Plane{400, 400}, builder.diffuse(0), {0, 0, 3}, {pi, 0, 0});
    builder.light("uniform", {{"radiance", 1.0}});
    const auto camera = camera::CameraModel::parallel(1000, 2, 2);
    const auto scene = builder.view(camera, {0, std::sin(angle), std::cos(angle)}, {pi + angle, 0, 0}).scene();
    expect_value(mean_of(render_view(scene, {.spp = 16384})), slab(std::cos(angle), 1.5, 40, 0.02), 1e-6);
  }
}

// A shell of glass with water that reaches into the glass, against water that meets it exactly: what has the higher
// priority fills the common part.
TEST(Nested, OverlapByPriorityIsAnExactContact) {
  const auto picture = [](double water_radius, int glass_priority, bool hollow) {
    SceneBuilder builder;
    const std::size_t shell = glass(builder, 1.5, 0, 5), water = glass(builder, 1.33, 0, 20);
    const std::size_t ground = builder.diffuse(0.5);
    builder.object(scene::Plane{4, 4}, ground, {0, 0, -0.3});
    builder.light("uniform", {{"radiance", 1.0}});
    io::TriangleMesh outer = tests::globe(0.1, 24, 48);
    if (hollow) {  // the cavity: a second surface that faces inwards
      const io::TriangleMesh inner = tests::globe(0.08, 24, 48);
      const auto first = static_cast<std::uint32_t>(outer.positions_m.size());
      for (const Vec3 p : inner.positions_m) outer.positions_m.push_back(p);
      for (const auto& t : inner.triangles) outer.triangles.push_back({first + t[0], first + t[2], first + t[1]});
    }
    builder.object(std::make_shared<const mesh::Mesh>(mesh::prepare(outer, mesh::Shading::flat, "outer")), shell);
    builder.object(std::make_shared<const mesh::Mesh>(
                       mesh::prepare(tests::globe(water_radius, 24, 48), mesh::Shading::flat, "water")),
                   water);
    auto scene = builder.view(pinhole(24, 40), {0, 0, 0.5}, {pi, 0, 0}).scene();
    scene.instances[1].priority = glass_priority;
    return render_view(scene, {.spp = 512, .seed = hollow ? 1u : 2u});
  };
  const io::Image overlapping = picture(0.09, 1, true);  // water into hollow glass, which pushes it back
  const io::Image matching = picture(0.08, -1, false);   // massive glass, which the water replaces
  double square = 0;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) {
      const double d = overlapping.at(x, y, 0) - matching.at(x, y, 0);
      const double v = overlapping.at(x, y, 3) + matching.at(x, y, 3);
      square += v > 0 ? d * d / v : 0;
    }
  // Mean square z over 576 pixels: 1.03 +- 0.06 for the replicates' degrees of freedom.
  EXPECT_NEAR(square / 576, 1.03, 0.3);
  const MeanAndError a = mean_of(overlapping), b = mean_of(matching);
  EXPECT_NEAR(a.mean, b.mean, z_limit * std::hypot(a.sigma, b.sigma));
}

// From above, a mark at depth d under water lies at depth d / eta for small angles: its place in the picture.
TEST(Refraction, ApparentDepth) {
  SceneBuilder builder;
  builder.object(box({-2, -2, -1}, {2, 2, 0}), glass(builder, 1.33));
  builder.object(scene::Plane{0.1, 0.1}, builder.diffuse(1), {0.15, 0, -0.5});
  builder.object(scene::Plane{10, 10}, builder.diffuse(0), {0, 0, -0.9});
  builder.light("uniform", {{"radiance", 1.0}});
  const camera::CameraModel camera({400, 400, 80, 1, {}}, 161, 3);
  const auto scene = builder.view(camera, {0, 0, 1}, {pi, 0, 0}).scene();
  const io::Image image = render_view(scene, {.spp = 256});
  double sum = 0, moment = 0;
  for (int x = 0; x < 161; ++x) {
    const double v = std::max(0.0, image.at(x, 1, 0) - 0.1);  // the surface mirrors 2 % of the sky
    sum += v;
    moment += v * x;
  }
  // The ray that reaches the mark's middle: sin i = eta sin r, tan i + 0.5 tan r = 0.15.
  double low = 0, high = 0.15;
  for (int i = 0; i < 60; ++i) {
    const double t = 0.5 * (low + high), s = t / std::sqrt(1 + t * t) / 1.33;
    (t + 0.5 * s / std::sqrt(1 - s * s) > 0.15 ? high : low) = t;
  }
  EXPECT_NEAR(moment / sum, 80 + 400 * low, 0.3);
  EXPECT_GT(80 + 400 * low - (80 + 400 * 0.1), 3);  // where it would be without water
}

// The camera under water sees what a camera above sees: no interface between it and a mark in the same water, which
// only absorbs.
TEST(Media, CameraInside) {
  SceneBuilder builder;
  builder.object(scene::Sphere{1}, glass(builder, 1, 0, 2));  // index 1: nothing but absorption
  builder.object(scene::Plane{0.5, 0.5}, builder.diffuse(0.8), {0, 0, -0.5});
  builder.light("point", {{"position_m", std::vector<double>{0, 0, 0.25}}, {"watt_per_sr", 1.0}});
  const auto scene = builder.view(pinhole(2, 1e6), {0, 0, 0}, {pi, 0, 0}).scene();
  const double truth = 0.8 / pi / (0.75 * 0.75) * std::exp(-2 * (0.5 + 0.75));
  expect_value(mean_of(render_view(scene, {.spp = 16})), truth, 1e-4);
}

// Shadow rays pass surfaces between equal indices; the lamp is outside.
TEST(Media, ShadowRaysPassMatchedInterfaces) {
  SceneBuilder builder;
  builder.object(scene::Sphere{0.2}, glass(builder, 1, 0, 3), {0, 0, 0.5});
  builder.object(scene::Plane{2, 2}, builder.diffuse(0.8));
  builder.light("point", {{"position_m", std::vector<double>{0, 0, 1}}, {"watt_per_sr", 1.0}});
  const auto scene = builder.look_down(0, 0, 1e-6, 2, 0.25).scene();
  expect_value(mean_of(render_view(scene, {.spp = 16})), 0.8 / pi * std::exp(-3 * 0.4), 1e-4);
}

// Three bands of different index: their means are those of three grey renderings.
TEST(Dispersion, MeanIsThatOfEachBandAlone) {
  const std::vector<double> etas = {1.3, 1.5, 1.9};
  const auto picture = [](const std::vector<double>& eta, double alpha, std::uint64_t seed) {
    SceneBuilder builder;
    builder.object(scene::Sphere{0.1}, builder.surface("dielectric", {{"eta", eta}, {"alpha", alpha}}));
    builder.object(scene::Plane{0.3, 0.1}, builder.diffuse(0.7), {0.1, 0, -0.2});
    builder.light("sphere", {{"position_m", std::vector<double>{0, 0, 1}}, {"watt_per_sr", 1.0}, {"radius_m", 0.3}});
    const auto scene = builder.view(pinhole(12, 20), {0, 0, 0.4}, {pi, 0, 0}).scene();
    return render_view(scene, {.spp = 512, .seed = seed, .transport = {.from_lights = false}});
  };
  for (const double alpha : {0.0, 0.3}) {
    const io::Image all = picture(etas, alpha, 1);
    for (int c = 0; c < 3; ++c) {
      const io::Image one = picture(grey(etas[c]), alpha, static_cast<std::uint64_t>(2 + c));
      double a = 0, b = 0, variance = 0;
      for (int y = 0; y < 12; ++y)
        for (int x = 0; x < 12; ++x) {
          a += all.at(x, y, c);
          b += one.at(x, y, c);
          variance += all.at(x, y, 3 + c) + one.at(x, y, 3 + c);
        }
      EXPECT_NEAR(a, b, z_limit * std::sqrt(variance)) << "alpha " << alpha << ", band " << c;
    }
  }
}

}  // namespace
}  // namespace gonio::render
