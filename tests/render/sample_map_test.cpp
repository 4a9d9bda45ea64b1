// Samples where noise counts: as much work as even samples, less error, no bias, and shares that still join.
#include "render/sample_map.h"

#include <gtest/gtest.h>

#include <cmath>

#include "made_up_integrator.h"
#include "render/film.h"
#include "render/stopping.h"
#include "scenes.h"

namespace gonio::render {
namespace {

using tests::MadeUpIntegrator;
using tests::pinhole;
using tests::SceneBuilder;

constexpr int samples = 16;

// Black, calm and noisy thirds of a picture.
class ThreeThirds final : public MadeUpIntegrator {
 public:
  explicit ThreeThirds(bool adaptive) : adaptive_(adaptive) {}
  void trace(Vec2 pixel, Sampler& sampler, std::span<Rgb> planes, Noticed& noticed) const override {
    const double x = std::floor(pixel.x + 0.5), spread = x < 16 ? 0.02 : 0.5;
    const double v = x < 8 ? 0 : 1 + spread * (2 * sampler.uniform() - 1);
    planes[0] += Rgb{v, v, v};
    noticed.events += v > 0 ? 1 : 0;
    noticed.near += v;
    if (v > 0) ++noticed.met;
  }
  const SampleMap* sample_map(int preset) const override {
    if (!adaptive_) return nullptr;
    if (!map_) map_.emplace(*this, 24, 16, preset);
    return &*map_;
  }

 private:
  bool adaptive_;
  mutable std::optional<SampleMap> map_;
};

TEST(SampleMap, FollowsTheNoiseAndKeepsToTheWork) {
  const ThreeThirds integrator(true);
  const SampleMap map(integrator, 24, 16, samples);
  double work = 0;
  for (int y = 0; y < 16; ++y)
    for (int x = 0; x < 24; ++x) {
      const int n = map.samples(x, y);
      EXPECT_EQ(n & (n - 1), 0);  // a power of two
      if (x < 7) {
        EXPECT_LE(n, samples);
      }
      if (x > 8 && x < 15) {
        EXPECT_LE(n, samples);
      }
      if (x > 16) {
        EXPECT_GE(n, samples);
      }
      work += n * (x < 8 ? 1 : 3);
    }
  EXPECT_LE(work, 16 * samples * (8 * 1 + 16 * 3) * 1.001);
  EXPECT_GT(work, 16 * samples * (8 * 1 + 16 * 3) * 0.95);
}

TEST(SampleMap, LessErrorForTheSameWork) {
  const ThreeThirds even(false), adaptive(true);
  const PassSums a = tests::made_up_passes(even, 0, 16, samples), b = tests::made_up_passes(adaptive, 0, 16, samples);
  EXPECT_LT(relative_error(b), 0.85 * relative_error(a));
  for (std::size_t pixel = 0; pixel < b.pixels(); ++pixel) {
    const bool lit = pixel % 24 >= 8;
    EXPECT_EQ(b.met(pixel), lit ? 1 : 0);  // shares of samples stay shares
    EXPECT_NEAR(b.mean(pixel, 0).y, lit ? 1 : 0, 0.02);
  }
}

TEST(SampleMap, SharesJoinToTheLastBit) {
  const ThreeThirds integrator(true);
  const io::Image whole = develop(tests::made_up_passes(integrator, 0, 6, samples), {});
  PassSums joined = tests::made_up_passes(ThreeThirds(true), 0, 2, samples);
  joined.append(tests::made_up_passes(ThreeThirds(true), 2, 4, samples));
  EXPECT_EQ(develop(joined, {}).data, whole.data);
}

// The same scene either way: sums over the picture agree (|z| < 4.5, false alarm 7e-6), the stated error is less, and
// the z of pixels have the spread that the stated variances claim: t with 30 degrees of freedom has a mean square of
// 30 / 28, of which 576 pixels' mean strays by 0.07.
TEST(SampleMap, PicturesAgreeAndTheirNoiseIsHonest) {
  SceneBuilder builder;
  builder.object(scene::Plane{0.6, 0.6}, builder.diffuse(0.5));
  builder.object(scene::Sphere{0.05}, builder.diffuse(0.7), {0, 0, 0.05});
  builder.light("point", {{"position_m", std::vector<double>{0.3, 0, 0.3}}, {"watt_per_sr", 1.0}});
  const auto scene = builder.view(pinhole(24, 60), {0, 0, 0.4}, {pi, 0, 0}).scene();
  const io::Image even = tests::render_view(scene, {.spp = 256, .seed = 1, .adaptive = false});
  const io::Image adaptive = tests::render_view(scene, {.spp = 256, .seed = 2, .adaptive = true});
  const double floor = 0.1 * tests::mean_of(even).mean;
  double difference = 0, variance = 0, square = 0, error_even = 0, error_adaptive = 0;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) {
      const double d = adaptive.at(x, y, 0) - even.at(x, y, 0), mean = even.at(x, y, 0);
      const double a = even.at(x, y, 3), b = adaptive.at(x, y, 3);
      difference += d;
      variance += a + b;
      square += a + b > 0 ? d * d / (a + b) : 0;
      error_even += a / (mean * mean + floor * floor);
      error_adaptive += b / (mean * mean + floor * floor);
    }
  EXPECT_NEAR(difference, 0, 4.5 * std::sqrt(variance));
  EXPECT_NEAR(square / 576, 1.07, 0.35);
  EXPECT_LT(error_adaptive, 0.8 * error_even);
}

}  // namespace
}  // namespace gonio::render
