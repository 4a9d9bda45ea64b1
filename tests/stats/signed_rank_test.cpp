// The signed-rank test: by hand, and its false alarms under heavy tails.
#include "stats/signed_rank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/random.h"

namespace gonio {
namespace {

// Five of 1 .. 5, all but the ranks 1 and 2 positive: a sum of at least 12 is left by taking away nothing, {1}, {2},
// {3} or {1, 2}, 5 of the 32 patterns of signs.
TEST(SignedRank, IsExactForFew) {
  EXPECT_NEAR(stats::signed_rank_upper(std::vector<double>{-0.1, -0.2, 0.4, 0.7, 1.3, 0}, 1), 5.0 / 32, 1e-15);
  EXPECT_NEAR(stats::signed_rank_upper(std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8}, 1), 1.0 / 256, 1e-15);
  EXPECT_EQ(stats::signed_rank_upper(std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8}), 1);  // fewer than twenty
  EXPECT_EQ(stats::signed_rank_upper(std::vector<double>{0, 0}, 0), 1);
  EXPECT_EQ(stats::signed_rank_upper(std::vector<double>{1, 2, 3, 4, 5, 6, 7, NAN}, 1), 1);
}

// Two of one size share rank 1.5: of + +, + -, - +, - - a sum of at least 1.5 has three.
TEST(SignedRank, EqualSizesShareTheirRanks) {
  EXPECT_NEAR(stats::signed_rank_upper(std::vector<double>{1, -1}, 1), 0.75, 1e-15);
}

// Where the exact law ends and the normal one begins, they say nearly the same: of 24 with every fourth negative, and
// of 25.
TEST(SignedRank, BothLawsMeet) {
  std::vector<double> d;
  for (int k = 1; k <= 24; ++k) d.push_back(k % 4 == 0 ? -k : k);
  const double exact = stats::signed_rank_upper(d), sum = 300, positive = sum - 84, squares = 24 * 25 * 49 / 6.0;
  EXPECT_NEAR(exact, 0.5 * std::erfc((2 * positive - sum) / std::sqrt(2 * squares)), 0.05 * exact);
}

// Sums of signed ranks by hand, five times each: 1 .. 5 with signs + - + + -.
TEST(SignedRank, RanksAreCountedWithTheirSigns) {
  std::vector<double> d{0};
  for (int k = 0; k < 5; ++k)
    for (const double v : {0.1, -0.2, 0.4, 0.7, -1.3}) d.push_back(v);
  // ranks 3, 8, 13, 18, 23: 5 (3 - 8 + 13 + 18 - 23) = 15 over sqrt(5 * 1095)
  EXPECT_NEAR(stats::signed_rank_upper(d), 0.5 * std::erfc(15 / std::sqrt(5475.0) / std::sqrt(2.0)), 1e-12);
}

// Cauchy's law, 4000 draws of 40: false alarms at 1 % within four standard errors (0.16 %).
TEST(SignedRank, FalseAlarmsAreAsStatedUnderHeavyTails) {
  int alarms = 0;
  for (int draw = 0; draw < 4000; ++draw) {
    Random random(5, static_cast<std::uint64_t>(draw));
    std::vector<double> d;
    for (int i = 0; i < 40; ++i) d.push_back(std::tan(std::acos(-1.0) * (random.uniform() - 0.5)));
    alarms += stats::signed_rank_upper(d) < 0.01;
  }
  EXPECT_NEAR(alarms / 4000.0, 0.01, 0.0063);
}

TEST(SignedRank, ManyThatAgreeCountWhateverOneIs) {
  std::vector<double> d(30, 0.0);
  for (std::size_t i = 0; i < d.size(); ++i) d[i] = 1 + 0.01 * static_cast<double>(i);
  d.push_back(-1e6);
  EXPECT_LT(stats::signed_rank_upper(d), 1e-4);
  for (double& v : d) v = -v;
  EXPECT_GT(stats::signed_rank_upper(d), 0.999);
}

}  // namespace
}  // namespace gonio
