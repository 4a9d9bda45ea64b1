// Intervals, robust centres and the sign-flip test. Statistical claims use fixed seeds; the chance that a correct implementation
// fails for fresh seeds is stated beside them.
#include "stats/intervals.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/random.h"
#include "stats/distributions.h"
#include "stats/sign_flip.h"

namespace gonio::stats {
namespace {

TEST(Intervals, MedianAndQuantiles) {
  const std::vector<double> v = {5, 1, 4, 2, 3};
  EXPECT_EQ(median(v), 3);
  EXPECT_EQ(quantile(v, 0), 1);
  EXPECT_EQ(quantile(v, 1), 5);
  EXPECT_DOUBLE_EQ(quantile(v, 0.125), 1.5);
  EXPECT_TRUE(std::isnan(median({})));
}

TEST(Intervals, RobustSigmaIgnoresAMinority) {
  Random random(3);
  std::vector<double> v(4000);
  for (double& x : v) x = 2 + 0.5 * random.normal();
  for (std::size_t i = 0; i < 400; ++i) v[i] = 1e6;
  EXPECT_NEAR(robust_sigma(v), 0.5, 0.1);  // 10 % outliers widen it by a seventh
}

TEST(Intervals, StandardErrorOfTheMean) {
  EXPECT_DOUBLE_EQ(standard_error(std::vector<double>{1, 2, 3, 4}), std::sqrt(5.0 / 12));
  EXPECT_TRUE(std::isinf(standard_error(std::vector<double>{1})));
}

TEST(Intervals, SidakIsExactForSmallP) {
  EXPECT_NEAR(sidak(0.01, 10), 1 - std::pow(0.99, 10), 1e-14);
  EXPECT_NEAR(sidak(1e-20, 50) / 5e-19, 1, 1e-12);
  EXPECT_EQ(sidak(1, 3), 1);
}

TEST(Intervals, ClopperPearson) {
  const Interval half = share_interval(5, 10);
  EXPECT_NEAR(half.lower, 0.187086, 1e-6);
  EXPECT_NEAR(half.upper, 0.812914, 1e-6);
  const Interval none = share_interval(0, 20);
  EXPECT_EQ(none.lower, 0);
  EXPECT_NEAR(none.upper, 1 - std::pow(0.025, 1.0 / 20), 1e-12);
}

// Scores of `blocks` blocks in `directions` directions, with heavy tails (the square of a normal, signed), plus a mean.
ScoreFamily family(Random& random, std::size_t blocks, std::size_t directions, double mean_score) {
  ScoreFamily f{directions, {}};
  for (std::size_t i = 0; i < blocks * directions; ++i) {
    const double z = random.normal();
    f.contributions.push_back(z * std::abs(z) + mean_score);
  }
  return f;
}

TEST(SignFlip, KeepsItsLevelUnderHeavyTails) {
  int alarms = 0;
  const int runs = 400;
  for (int run = 0; run < runs; ++run) {
    Random random(17, static_cast<std::uint64_t>(run));
    const std::vector<ScoreFamily> families = {family(random, 150, 1, 0), family(random, 150, 4, 0)};
    alarms += sign_flip_test(families, 150, 1, 199, 5).global_p <= 0.05;
  }
  EXPECT_GT(binomial_upper(alarms, runs, 0.05), 1e-4) << alarms;  // false alarm of this test: 1e-4
}

TEST(SignFlip, FindsAMeanAndSaysWhere) {
  Random random(23);
  const std::vector<ScoreFamily> families = {family(random, 150, 2, 0), family(random, 150, 3, 1)};
  const SignFlipResult r = sign_flip_test(families, 150, 1, 999, 5);
  EXPECT_LE(r.global_p, 0.001);
  EXPECT_LE(r.adjusted_p[1], 0.001);
  EXPECT_GT(r.adjusted_p[0], 0.01);
  EXPECT_EQ(r.rank[1], 3u);
}

TEST(SignFlip, DirectionsThatRepeatCountOnce) {
  Random random(29);
  ScoreFamily f{2, {}};
  for (int b = 0; b < 100; ++b) {
    const double z = random.normal();
    f.contributions.push_back(z);
    f.contributions.push_back(-3 * z);
  }
  EXPECT_EQ(sign_flip_test({f, {0, {}}}, 100, 1, 9, 1).rank, (std::vector<std::size_t>{1, 0}));
}

TEST(SignFlip, SameSeedSameAnswer) {
  Random random(31);
  const std::vector<ScoreFamily> families = {family(random, 60, 2, 0.2)};
  EXPECT_EQ(sign_flip_test(families, 60, 1, 499, 8).global_p, sign_flip_test(families, 60, 1, 499, 8).global_p);
}

}  // namespace
}  // namespace gonio::stats
