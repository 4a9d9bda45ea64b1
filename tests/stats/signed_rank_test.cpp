// The signed-rank test: by hand, and its false alarms under heavy tails.
#include "stats/signed_rank.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "base/random.h"

namespace gonio {
namespace {

// Sums of signed ranks by hand: of 1 .. 5 with signs + - + + -, twice each.
TEST(SignedRank, RanksAreCountedWithTheirSigns) {
  const std::vector<double> d{0.1, -0.2, 0.4, 0.7, -1.3, 0.1, -0.2, 0.4, 0.7, -1.3, 0};
  // ranks 1.5 3.5 5.5 7.5 9.5, each twice: 2 (1.5 - 3.5 + 5.5 + 7.5 - 9.5) = 3 over sqrt(2 * 191.25)
  EXPECT_NEAR(stats::signed_rank_upper(d, 1), 0.5 * std::erfc(3 / std::sqrt(382.5) / std::sqrt(2.0)), 1e-12);
  EXPECT_EQ(stats::signed_rank_upper(d), 1);  // too few
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
