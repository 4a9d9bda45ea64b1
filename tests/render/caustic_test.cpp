// Light that reaches a surface through glass or by way of a mirror: paths from the lamps against closed forms and
// against paths from the camera alone. |z| < 4.5 for sums over the picture: false alarm 7e-6 each.
#include "render/caustic.h"

#include <gtest/gtest.h>

#include "scenes.h"
#include "two_sided.h"

namespace gonio::render {
namespace {

using tests::pinhole;
using tests::pinhole_lens;
using tests::SceneBuilder;
using tests::two_sided;

std::vector<double> grey(double v) {
  return {v, v, v};
}
std::size_t glass(SceneBuilder& builder, double eta, double absorption = 0) {
  return builder.surface("dielectric", {{"eta", grey(eta)}, {"sigma_a_per_m", grey(absorption)}});
}
std::shared_ptr<const mesh::Mesh> slab(double half, double depth, double top) {
  io::TriangleMesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.positions_m.push_back({i & 1 ? half : -half, i & 2 ? half : -half, i & 4 ? top : top - depth});
  for (const auto& f : {std::array<std::uint32_t, 4>{0, 2, 3, 1},
                        {4, 5, 7, 6},
                        {0, 1, 5, 4},
                        {2, 6, 7, 3},
                        {0, 4, 6, 2},
                        {1, 3, 7, 5}}) {
    mesh.triangles.push_back({f[0], f[1], f[2]});
    mesh.triangles.push_back({f[0], f[2], f[3]});
  }
  return std::make_shared<const mesh::Mesh>(mesh::prepare(mesh, mesh::Shading::flat, "slab"));
}

// A point lamp over black glass (it absorbs what enters) lights a ceiling directly, and once more from its mirror
// image:
//   L = albedo / pi I (cos / d^2 + F(theta) cos' / d'^2)
// at a point that is x beside the lamp, h = 0.5 above it and 1.5 above its image.
TEST(Caustic, MirrorImageOfAPointLamp) {
  for (const double x : {0.0, 0.5, 1.2}) {
    SceneBuilder builder;
    builder.object(slab(5, 0.1, 0), glass(builder, 1.5, 1e4));
    builder.object(scene::Plane{8, 8}, builder.diffuse(0.6), {0, 0, 1}, {pi, 0, 0});
    builder.light("point", {{"position_m", std::vector<double>{0, 0, 0.5}}, {"watt_per_sr", 2.0}});
    const auto camera = camera::CameraModel::parallel(2, 2, 2);  // looks up; 2 x 2 pixels of half a metre
    const auto scene = builder.view(camera, {x, 0, 0.7}, {0, 0, 0}).scene();
    const RayCaster caster(scene.instances);
    const auto found = two_sided(scene, caster, {.max_bounces = 4}, 16, 256, 30000);
    double truth = 0, direct = 0;  // means over the picture
    constexpr int n = 64;
    for (int i = 0; i < n * n; ++i) {
      const double px = x - 0.5 + (i % n + 0.5) / n, py = -0.5 + (i / n + 0.5) / n, beside = px * px + py * py;
      const double near = beside + 0.25, far = beside + 2.25;
      const double c = 1.5 / std::sqrt(far), t = std::sqrt(1 - (1 - c * c) / 2.25);
      const double s = (c - 1.5 * t) / (c + 1.5 * t), p = (1.5 * c - t) / (1.5 * c + t);
      direct += 0.6 / pi * 2 * 0.5 / (near * std::sqrt(near)) / (n * n);
      truth += 0.6 / pi * 2 * (s * s + p * p) / 2 * c / far / (n * n);
    }
    const double caustic = tests::TwoSided::sum(found.from_lights) / 4;
    EXPECT_GT(truth, 10 * found.sigma() / 4) << "too few photons for a judgement";
    EXPECT_NEAR(caustic, truth, 4.5 * found.sigma() / 4 + 2e-4 * truth) << x;
    // The ceiling lights the black glass, which mirrors a hundredth back.
    EXPECT_GT(found.total() / 4, direct + truth - 4.5 * found.sigma() / 4);
    EXPECT_LT(found.total() / 4, 1.02 * (direct + truth) + 4.5 * found.sigma() / 4);
  }
}

struct Lens {
  SceneBuilder builder;
  explicit Lens(double radius_m = 0.08) {
    builder.object(scene::Sphere{0.1}, glass(builder, 1.5), {0, 0, 0.3});
    builder.object(scene::Plane{2, 2}, builder.diffuse(0.7));
    builder.light("sphere",
                  {{"position_m", std::vector<double>{0.1, 0, 1}}, {"watt_per_sr", 1.0}, {"radius_m", radius_m}});
  }
};

// Both ways of finding a ball lens' caustic, for several cameras; the one without paths from the lamp needs luck.
void expect_agreement(const scene::Scene& scene, int samples) {
  const RayCaster caster(scene.instances);
  const auto both = two_sided(scene, caster, {}, 16, samples / 4, 50000);
  const auto alone = two_sided(scene, caster, {.from_lights = false}, 16, samples, 0, 2);
  EXPECT_GT(tests::TwoSided::sum(both.from_lights), 0.05 * both.total());
  EXPECT_NEAR(both.total(), alone.total(), 4.5 * std::hypot(both.sigma(), alone.sigma()));
  EXPECT_LT(both.sigma(), 0.04 * both.total());
}
TEST(Caustic, BallLensSeenByAnOrthographicCamera) {
  Lens lens;
  expect_agreement(lens.builder.look_down(-0.03, 0, 0.2, 8, 0.15).scene(), 256);
}
TEST(Caustic, BallLensSeenThroughADistortingLens) {
  Lens lens;
  camera::Intrinsics distorting = pinhole_lens(12, 14);
  distorting.distortion[camera::LensTerm::k1] = -0.2;
  distorting.distortion[camera::LensTerm::p1] = 0.02;
  expect_agreement(lens.builder.view({distorting, 12, 12}, {0.35, 0, 0.3}, {0, -pi + 0.8, 0}).scene(), 256);
}
TEST(Caustic, BallLensOutOfFocus) {
  Lens lens;
  auto scene = lens.builder.view(pinhole(12, 14), {0.35, 0, 0.3}, {0, -pi + 0.8, 0}).scene();
  scene.views[0].lens = {.aperture_radius_m = 0.02, .focus_m = 0.2};
  expect_agreement(scene, 256);
}

// A lamp of a hundredth of the size is no harder; to paths from the camera it is ten thousand times rarer.
TEST(Caustic, NoiseDoesNotGrowForSmallLamps) {
  const auto relative = [](double radius_m) {
    Lens lens(radius_m);
    const auto scene = lens.builder.look_down(-0.03, 0, 0.2, 8, 0.15).scene();
    const RayCaster caster(scene.instances);
    const auto found = two_sided(scene, caster, {}, 16, 16, 50000);
    return found.sigma() / found.total();
  };
  EXPECT_LT(relative(0.0008), 2 * relative(0.08));
}

// The bottom of a glass body, lit and seen through its polished top: no path finds a point lamp's light there, and it
// is said. What the camera sees directly is not missing; a lamp with an extent is found by paths from the camera.
TEST(Caustic, LightThatNoPathFindsIsNamed) {
  const auto missing = [](double height_of_camera, double lamp_radius, double alpha) {
    SceneBuilder builder;
    builder.object(slab(1, 0.2, 0.2), builder.surface("dielectric", {{"eta", grey(1.5)}, {"alpha", alpha}}));
    builder.object(scene::Plane{1, 1}, builder.diffuse(0.5), {0, 0, 0.1});
    builder.light("point",
                  {{"position_m", std::vector<double>{0, 0, 0.6}}, {"watt_per_sr", 1.0}, {"radius_m", lamp_radius}});
    const auto scene = builder.view(pinhole(32, 8), {0, 0, height_of_camera}, {pi, 0, 0}).scene();
    return missing_light(scene, 0, RayCaster(scene.instances));
  };
  const Missing found = missing(0.5, 0, 0);
  ASSERT_EQ(found.lamps.size(), 1u);
  EXPECT_EQ(found.lamps[0].light, "l0");
  EXPECT_EQ(found.lamps[0].objects, "o1");
  // The plane, 0.5 m below and 1 m wide, seen through glass, receives about the light of the cone that it fills:
  // solid angle 4 asin(1 / (1 + 4 h^2)) / (4 pi), h = 0.5 - 0.1 / 3 for what the glass lifts it; less what is
  // reflected.
  const double h = 0.5 - 0.1 / 3, cone = 4 * std::asin(0.25 / (0.25 + h * h)) / (4 * pi);
  EXPECT_NEAR(found.lamps[0].share, 0.95 * cone, 0.1 * cone);
  EXPECT_NE(found.sentence().find("\"l0\" lacks about"), std::string::npos);
  EXPECT_TRUE(missing(0.15, 0, 0).lamps.empty());    // the camera is inside of the glass
  EXPECT_TRUE(missing(0.5, 0.01, 0).lamps.empty());  // the lamp can be hit
  EXPECT_TRUE(missing(0.5, 0, 0.05).lamps.empty());  // rough: light is sampled through it
}

// Nothing hangs on the number of threads, or on how the paths are shared out.
TEST(Caustic, SharesOfPathsAreTheSamePaths) {
  Lens lens;
  const auto scene = lens.builder.look_down(-0.03, 0, 0.2, 4, 0.15).scene();
  const RayCaster caster(scene.instances);
  const auto integrator = path_integrator(scene, 0, caster, {});
  tests::SumOfSplats all(4, 4, 1), parts(4, 4, 1);
  integrator->trace_from_lights(3, 0, 30000, all);
  integrator->trace_from_lights(3, 0, 10000, parts);
  integrator->trace_from_lights(3, 10000, 20000, parts);
  double whole = 0, shared = 0;
  tests::SumOfSplats first(4, 4, 1), second(4, 4, 1);
  integrator->trace_from_lights(3, 0, 10000, first);
  integrator->trace_from_lights(3, 10000, 20000, second);
  for (std::size_t i = 0; i < 16; ++i) {
    whole += all.values[0][i].y;
    shared += first.values[0][i].y / 3 + second.values[0][i].y * 2 / 3;
  }
  ASSERT_GT(whole, 0);
  EXPECT_NEAR(shared, whole, 1e-9 * whole);
}

}  // namespace
}  // namespace gonio::render
