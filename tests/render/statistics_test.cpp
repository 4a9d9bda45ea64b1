// The stated variance is the variance; samples stratify; seeds and threads do what they promise.
#include <gtest/gtest.h>

#include "base/parallel.h"
#include "light/irradiance.h"
#include "render/stopping.h"
#include "scenes.h"

namespace gonio::render {
namespace {

using tests::pinhole;
using tests::render_view;
using tests::SceneBuilder;

scene::Scene busy_scene() {
  SceneBuilder builder;
  builder.object(scene::Plane{1, 1}, builder.diffuse(0.6));
  builder.object(scene::Sphere{0.1}, builder.surface("coated-diffuse", {{"albedo", 0.4}, {"f0", 0.05}, {"alpha", 0.2}}),
                 {0, 0, 0.1});
  builder.object(
      std::make_shared<const mesh::Mesh>(mesh::prepare(tests::globe(0.05, 20, 40), mesh::Shading::smooth, "globe")),
      builder.surface("metal", {{"f0", 0.9}, {"alpha", 0.3}}), {0.15, 0.02, 0.05});
  builder.light("sphere",
                {{"position_m", std::vector<double>{0.3, -0.2, 0.5}}, {"watt_per_sr", 1.0}, {"radius_m", 0.08}});
  builder.light("uniform", {{"radiance", 0.3}});
  return builder.view(pinhole(24, 30), {0, -0.05, 0.7}, {pi, 0, 0}).scene();
}

TEST(SamplePlan, CoversWhatWasAskedFor) {
  for (int spp = 1; spp <= 5000; ++spp) {
    const SamplePlan plan = sample_plan(spp);
    EXPECT_GE(plan.spp(), spp);
    EXPECT_LT(plan.spp(), spp + plan.samples_per_pass + 1);
    EXPECT_GE(plan.passes, 2);
    EXPECT_EQ(plan.samples_per_pass & (plan.samples_per_pass - 1), 0);
    EXPECT_LE(plan.samples_per_pass, 64);
  }
  EXPECT_EQ(sample_plan(256).samples_per_pass, 16);
  EXPECT_EQ(sample_plan(256).passes, 16);
  EXPECT_EQ(sample_plan(1000).spp(), 1024);  // 32 passes of 32
}

// Mean stated variance against the variance among independent seeds, pixel by pixel; 40 seeds of 576 pixels: the
// ratio's own standard deviation is below 1.5 %.
TEST(Variance, IsUnbiased) {
  const auto scene = busy_scene();
  const RayCaster caster(scene.instances);
  constexpr int seeds = 40;
  std::vector<double> sum(576), squares(576);
  double stated = 0, found = 0;
  for (int seed = 0; seed < seeds; ++seed) {
    const io::Image image =
        render(scene, 0, caster, {.spp = 32, .seed = static_cast<std::uint64_t>(seed), .geometry = false});
    for (std::size_t i = 0; i < 576; ++i) {
      const double v = image.data[6 * i];
      sum[i] += v;
      squares[i] += v * v;
      stated += image.data[6 * i + 3] / seeds;
    }
  }
  for (std::size_t i = 0; i < 576; ++i) found += (squares[i] - sum[i] * sum[i] / seeds) / (seeds - 1);
  EXPECT_NEAR(stated / found, 1, 0.1);
}

// z of every pixel between two seeds with the stated variances: mean square near what 31 + 31 degrees of freedom give,
// 62 / 60 = 1.03; standard deviation of the mean square over 576 x 1 pixels about 0.06. Limits at 4 of them.
TEST(Variance, ExplainsTheDifferenceOfTwoSeeds) {
  const auto scene = busy_scene();
  const io::Image a = render_view(scene, {.spp = 128, .seed = 1}), b = render_view(scene, {.spp = 128, .seed = 2});
  const int value = a.channel("R"), variance = a.channel("variance.R");
  double sum = 0;
  int count = 0;
  for (int y = 0; y < a.height; ++y)
    for (int x = 0; x < a.width; ++x) {
      const double v = a.at(x, y, variance) + b.at(x, y, variance), d = a.at(x, y, value) - b.at(x, y, value);
      if (v <= 0) continue;
      sum += d * d / v;
      ++count;
    }
  ASSERT_GT(count, 500);
  EXPECT_NEAR(sum / count, 1.03, 0.25);
}

TEST(Estimators, AgreeWithEachOther) {
  const auto scene = busy_scene();
  const io::Image a = render_view(scene, {.spp = 256, .seed = 1});
  const io::Image b = render_view(scene, {.spp = 1024, .seed = 2, .transport = {.estimator = Estimator::lights_only}});
  const auto mean_a = tests::mean_of(a), mean_b = tests::mean_of(b);
  EXPECT_NEAR(mean_a.mean, mean_b.mean, 4.5 * std::hypot(mean_a.sigma, mean_b.sigma));
}

TEST(Determinism, SameBytesWhateverTheNumberOfThreads) {
  const auto scene = busy_scene();
  set_threads(1);
  const io::Image one = render_view(scene, {.spp = 16, .seed = 7});
  for (const int count : {2, 3, 8}) {
    set_threads(count);
    EXPECT_EQ(render_view(scene, {.spp = 16, .seed = 7}).data, one.data) << count << " threads";
  }
  set_threads(0);
  EXPECT_NE(render_view(scene, {.spp = 16, .seed = 8}).data, one.data);
}

TEST(Passes, ReduceTheNoiseOfPenumbras) {
  SceneBuilder builder;
  builder.object(scene::Plane{2, 2}, builder.diffuse(0.5));
  builder.object(scene::Plane{0.2, 2}, builder.diffuse(0), {-0.1, 0, 0.2});
  builder.light("sphere", {{"position_m", std::vector<double>{0, 0, 0.5}}, {"watt_per_sr", 1.0}, {"radius_m", 0.05}});
  const auto scene = builder.look_down(0.0, 0, 0.02, 8, 0.1).scene();  // below the edge, across the penumbra
  const double fine =
      tests::mean_of(render_view(scene, {.spp = 1024, .transport = {.max_bounces = 1}})).sigma;  // 64 samples a pass
  const double coarse = tests::mean_of(render_view(scene, {.spp = 16, .transport = {.max_bounces = 1}})).sigma /
                        8;  // one sample a pass; per sample
  EXPECT_LT(fine, 0.5 * coarse);
}

}  // namespace
}  // namespace gonio::render
