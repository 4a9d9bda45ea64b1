// Sessions: goals are reached, what is said of noise is true in a scene with soft shadows and light that bounces, and
// layers of single lights add up.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "progressive_scene.h"
#include "stats/distributions.h"

namespace gonio::render {
namespace {

using tests::rendered;
using tests::small_scene;

// Pictures under --noise against a reference with many samples, whose own variance is taken off.
struct Held {
  double ratio = 0,
         ratio_error = 0;  // sum of the true squared relative errors over that of the stated ones, +- one sigma
  double coverage = 0;  // share of values within the 95 % limits of Student's t for the passes that each picture took
  double usual = 0;     // root mean square over the pictures of their true relative error
  double worst = 0;     // the largest
  double least_bound = 1;
};

struct Sums {
  double is = 0, stated = 0;
  int covered = 0, all = 0;
};

// Of one picture, its red channel.
Sums sums_of(const PassSums& picture, const PassSums& exact) {
  const double limit = stats::student_quantile(0.975, picture.passes() - 1.0);
  Sums sums;
  for (std::size_t pixel = 0; pixel < exact.pixels(); ++pixel) {
    const double y = exact.mean(pixel, 0).x, d = picture.mean(pixel, 0).x - y, v = picture.variance(pixel, 0).x,
                 v_exact = exact.variance(pixel, 0).x;
    if (!(y > 0)) continue;
    sums.is += (d * d - v_exact) / (y * y), sums.stated += v / (y * y);
    if (std::abs(d) <= limit * std::sqrt(v + v_exact)) ++sums.covered;
    ++sums.all;
  }
  return sums;
}

Held hold(const manifest::Document& document, double goal, int reference_spp, std::uint64_t seeds) {
  const Rendered truth = rendered(document, {.seed = 77, .geometry = false, .spp = reference_spp});
  Held held;
  Sums sum;
  std::vector<double> rest;  // of each seed, true - stated
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const Rendered picture = rendered(document, {.seed = seed, .geometry = false, .relative_error = goal});
    EXPECT_LE(picture.facts.relative_error, goal);
    held.least_bound = std::min(held.least_bound, estimate_error(*picture.sums).bound);
    const Sums own = sums_of(*picture.sums, *truth.sums);
    sum.is += own.is, sum.stated += own.stated, sum.covered += own.covered, sum.all += own.all;
    rest.push_back(own.is - own.stated);
    held.worst = std::max(held.worst, std::sqrt(std::max(0.0, own.is) / own.all));
  }
  const auto n = static_cast<double>(seeds);
  double squares = 0;
  for (const double r : rest) squares += std::pow(r - (sum.is - sum.stated) / n, 2);
  held.ratio = sum.is / sum.stated;
  held.usual = std::sqrt(sum.is / sum.all);
  held.ratio_error = std::sqrt(squares * n / (n - 1)) / sum.stated;
  held.coverage = sum.covered / static_cast<double>(sum.all);
  testing::Test::RecordProperty("true_over_stated_variance",
                                std::to_string(held.ratio) + " +- " + std::to_string(held.ratio_error));
  testing::Test::RecordProperty("coverage_of_95_percent", std::to_string(held.coverage));
  testing::Test::RecordProperty("worst_over_goal", std::to_string(held.worst / goal));
  return held;
}

// Skewed samples cost a little coverage.
TEST(Noise, StatedErrorsAreTrueAndCoverTheTruth) {
  const Held held = hold(small_scene(), 0.004, 8192, 12);
  EXPECT_NEAR(held.ratio, 1, 4 * held.ratio_error + 0.01);
  EXPECT_LT(held.ratio_error, 0.1);
  EXPECT_GT(held.coverage, 0.925);
  EXPECT_LT(held.coverage, 0.97);
  EXPECT_LT(held.usual, 0.004);
  EXPECT_LT(held.worst, 1.05 * 0.004);  // one picture's error of 216 pixels scatters about what is stated
  EXPECT_GT(held.least_bound, 0.9 * 0.004) << "later than it could";
}

// Caustics: rare paths with much light, which few samples miss. In a picture of 216 pixels some of that remains: of ten
// pictures the worst is 1.6 times as wrong as was asked for; without the bound and the neighbours it was 2.8 times, and
// pictures stopped after anything between 64 and 2000 samples.
TEST(Noise, StatedErrorsAreTrueWhereRarePathsCarryMuch) {
  const Held held = hold(small_scene(tests::glass(), "[0.5, 0.3, 0.1]"), 0.12, 4096, 10);
  EXPECT_NEAR(held.ratio, 1, 4 * held.ratio_error + 0.05);
  EXPECT_LT(held.ratio_error, 0.25);
  EXPECT_GT(held.coverage, 0.87);
  EXPECT_LT(held.worst, 2 * 0.12);
}

TEST(Noise, FourTimesTheSamplesForHalfTheError) {
  const auto document = small_scene();
  const auto samples = [&](double error) {
    return static_cast<double>(rendered(document, {.geometry = false, .relative_error = error}).facts.samples());
  };
  EXPECT_NEAR(samples(0.003) / samples(0.006), 4, 1.2);
}

// Sums of floats: each plane is rounded once per pass.
TEST(PerLight, LayersAddUpToTheWhole) {
  SessionOptions options{.geometry = false, .spp = 32};
  options.transport.per_light = true;
  for (const char* ball : {R"({"model": "metal", "f0": [0.9, 0.8, 0.7], "alpha": 0.3})", tests::glass()}) {
    const Rendered picture = rendered(small_scene(ball, "[0.5, 0.3, 0.1]"), options);
    const PassSums& sums = *picture.sums;
    ASSERT_THAT(sums.identity().planes, testing::ElementsAre("", "light.large", "light.small", "light.ambient"));
    std::vector<double> largest(4);
    for (std::size_t pixel = 0; pixel < sums.pixels(); ++pixel) {
      const Rgb whole = sums.mean(pixel, 0);
      const Rgb parts = sums.mean(pixel, 1) + sums.mean(pixel, 2) + sums.mean(pixel, 3);
      EXPECT_LE(max_component(whole - parts), 4e-7 * max_component(whole)) << pixel;
      EXPECT_LE(max_component(parts - whole), 4e-7 * max_component(whole)) << pixel;
      for (std::size_t plane = 0; plane < 4; ++plane)
        largest[plane] = std::max(largest[plane], max_component(sums.mean(pixel, plane)));
    }
    for (const double l : largest) EXPECT_GT(l, 0);
    // They do not disturb the picture.
    EXPECT_EQ(rendered(small_scene(ball, "[0.5, 0.3, 0.1]"), {.geometry = false, .spp = 32}).facts.relative_error,
              picture.facts.relative_error);
  }
}

TEST(Ranges, OfSamples) {
  const auto range = [](SessionOptions options) { return pass_range(options); };
  EXPECT_EQ(range({}).samples_per_pass, 16);
  EXPECT_EQ(range({}).end, 16u);
  EXPECT_EQ(range({.spp = 64, .samples = "8:24"}).first, 2u);
  EXPECT_EQ(range({.spp = 64, .samples = "8:24"}).end, 6u);
  EXPECT_EQ(range({.relative_error = 0.1}).end * 16u, 1u << 20);
  for (const char* bad : {"", ":", "1", "4:4", "8:4", "-4:4", "4:8:12", "4.0:8", "0:68", "2:8", "0x4:8", " 4:8", "4:8 ",
                          "0:99999999999999999999"})
    if (*bad != 0) {
      EXPECT_THROW(range({.spp = 64, .samples = bad}), Error) << bad;
    }
}

TEST(Pictures, BlackOnesHaveNoErrorAndEnd) {
  manifest::Document dark = small_scene(R"({"model": "diffuse", "albedo": [0, 0, 0]})", "[0, 0, 0]");
  const Rendered picture = rendered(dark, {.geometry = false, .relative_error = 0.01}, 1);
  EXPECT_EQ(picture.facts.relative_error, 0);
  EXPECT_EQ(picture.facts.samples(), 64);
}

}  // namespace
}  // namespace gonio::render
