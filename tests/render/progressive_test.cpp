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

// Against a reference of 8192 samples, whose own variance is small and is taken off, over 12 seeds: the sum of the true
// squared relative errors over that of the stated ones; its standard error from the seeds. And of all values, how many
// lie within the 95 % limits of Student's t for the passes that each picture took; skewed samples cost a little.
TEST(Noise, StatedErrorsAreTrueAndCoverTheTruth) {
  constexpr double goal = 0.004;
  constexpr int seeds = 12;
  const auto document = small_scene();
  const Rendered truth = rendered(document, {.seed = 77, .geometry = false, .spp = 8192});
  const PassSums& exact = *truth.sums;
  double sum_true = 0, sum_stated = 0;
  std::vector<double> rest;  // of each seed, true - stated
  int covered = 0, all = 0;
  for (std::uint64_t seed = 0; seed < seeds; ++seed) {
    const Rendered picture = rendered(document, {.seed = seed, .geometry = false, .relative_error = goal});
    EXPECT_LE(picture.facts.relative_error, goal);
    EXPECT_GT(picture.facts.relative_error, 0.9 * goal) << "later than it could";
    const double limit = stats::student_quantile(0.975, picture.sums->passes() - 1.0);
    double is = 0, stated = 0;
    for (std::size_t pixel = 0; pixel < exact.pixels(); ++pixel) {
      const double y = exact.mean(pixel, 0).x, d = picture.sums->mean(pixel, 0).x - y,
                   v = picture.sums->variance(pixel, 0).x, v_exact = exact.variance(pixel, 0).x;
      if (!(y > 0)) continue;
      is += (d * d - v_exact) / (y * y), stated += v / (y * y);
      if (std::abs(d) <= limit * std::sqrt(v + v_exact)) ++covered;
      ++all;
    }
    EXPECT_NEAR(std::sqrt(stated / all * (seed + 1.0)) / picture.facts.relative_error, 1, 0.2) << "red as all channels";
    sum_true += is, sum_stated += stated;
    rest.push_back(is - stated);
  }
  double squares = 0;
  const double mean_rest = (sum_true - sum_stated) / seeds;
  for (const double r : rest) squares += (r - mean_rest) * (r - mean_rest);
  const double ratio = sum_true / sum_stated, error = std::sqrt(squares * seeds / (seeds - 1)) / sum_stated;
  const double coverage = covered / static_cast<double>(all);
  RecordProperty("true_over_stated_variance", std::to_string(ratio) + " +- " + std::to_string(error));
  RecordProperty("coverage_of_95_percent", std::to_string(coverage));
  EXPECT_NEAR(ratio, 1, 4 * error + 0.01);
  EXPECT_LT(error, 0.1);
  EXPECT_GT(coverage, 0.925);
  EXPECT_LT(coverage, 0.97);
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
