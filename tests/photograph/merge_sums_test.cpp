// Sums over exposures, a run of pixels at a time: against the same written pixel by pixel in double precision.
#include "photograph/merge_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace gonio::photograph {
namespace {

constexpr float full_scale = 4000;

// Pixels of all kinds, rates from dark to far beyond full scale, and a count that no vector divides.
struct Pixels {
  std::vector<float> codes, rates;
  std::vector<SampleKind> kinds;
  ExposureRun run;
};
Pixels pixels(std::uint64_t seed) {
  Pixels p;
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> share(0, 1);
  for (int i = 0; i < 1003; ++i) {
    p.rates.push_back(static_cast<float>(std::pow(10.0, 1 + 5 * share(random))));
    p.codes.push_back(static_cast<float>(p.rates.back() * 0.25 + 10 * (share(random) - 0.5)));
    p.kinds.push_back(share(random) < 0.1        ? SampleKind::unusable
                      : p.codes[i] >= full_scale ? SampleKind::full
                                                 : SampleKind::read);
  }
  p.run = {p.codes, p.kinds, 0, 0.25f, 3};
  return p;
}

TEST(MergeSums, SayWhatTheFormulasSay) {
  const Pixels p = pixels(1);
  const NoiseModel noise(4, 2);
  const NoiseVariance variance_of(noise);
  ScoreSums sums(p.codes.size());
  EXPECT_TRUE(sums.add(p.run, p.rates, variance_of, full_scale));
  std::vector<float> squares(p.codes.size());
  std::vector<std::uint8_t> readings(p.codes.size());
  add_squares(p.run, p.rates, variance_of, full_scale, squares, readings);
  int near = 0, counted = 0;
  for (std::size_t i = 0; i < p.codes.size(); ++i) {
    const double t = p.run.exposure_s, expected = p.rates[i] * t, variance = expected / 4 + 4,
                 below_full = (full_scale - expected) / std::sqrt(variance);
    const bool usable = p.kinds[i] != SampleKind::unusable, read = p.kinds[i] == SampleKind::read;
    EXPECT_EQ(sums.near[i] != 0, usable && std::abs(below_full) < far_from_full) << i;
    near += sums.near[i];
    const double score = read && sums.near[i] == 0 ? t / variance * (p.codes[i] - expected) : 0,
                 information = usable && below_full >= far_from_full ? t * t / variance : 0;
    EXPECT_NEAR(sums.score[i], score, 1e-3 * t / std::sqrt(variance)) << i;
    EXPECT_NEAR(sums.information[i], information, 1e-6 * t * t / variance) << i;
    const bool counts = read && below_full >= clear_of_full;
    EXPECT_EQ(readings[i], counts ? 1 : 0) << i;
    EXPECT_NEAR(squares[i], counts ? std::pow(p.codes[i] - expected, 2) / variance : 0, 2e-3) << i;
    counted += readings[i];
  }
  EXPECT_GT(near, 5);
  EXPECT_GT(counted, 100);
}

TEST(MergeSums, ATableOfVariancesIsWhatItsLineIs) {
  const Pixels p = pixels(2);
  const NoiseModel line(4, 2);
  NoiseModel table(4, 2);
  table.spacing = 2000;
  for (int i = 0; i < 60; ++i) table.variances.push_back(4 + 2000.0 * i / 4);
  ScoreSums one(p.codes.size()), other(p.codes.size());
  one.add(p.run, p.rates, NoiseVariance(line), full_scale), other.add(p.run, p.rates, NoiseVariance(table), full_scale);
  EXPECT_EQ(one.near, other.near);
  for (std::size_t i = 0; i < p.codes.size(); ++i)  // rates end below the table's end
    EXPECT_NEAR(one.score[i], other.score[i], 1e-5 * std::abs(one.score[i])) << i;
}

TEST(MergeSums, LightBeginsWhereARunDoesAndKnowsItsExposures) {
  const std::vector<float> codes{10, 20, 5000, 7};
  const std::vector<SampleKind> kinds{SampleKind::read, SampleKind::unusable, SampleKind::full, SampleKind::read};
  LightSums sums(6);
  sums.add({codes, kinds, 2, 0.5f, 1}, full_scale), sums.add({codes, kinds, 2, 1.0f, 2}, full_scale);
  EXPECT_EQ(sums.light, (std::vector<float>{0, 0, 20, 0, 0, 14}));
  EXPECT_EQ(sums.time_s, (std::vector<float>{0, 0, 1.5f, 0, 0, 1.5f}));
  EXPECT_EQ(sums.bound[4], full_scale);
  EXPECT_TRUE(std::isinf(sums.bound[3]));
  EXPECT_EQ(sums.first[2], 1);
  EXPECT_EQ(sums.last[2], 2);
}

}  // namespace
}  // namespace gonio::photograph
