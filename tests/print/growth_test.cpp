#include "print/growth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "base/error.h"
#include "base/random.h"
#include "stats/distributions.h"

namespace gonio::print {
namespace {

constexpr double um = 1e-6;
const GrowthLaw published{17.71 * um, 10.24 * um, -0.01};  // Luongo et al. 2020

TEST(GrowthLaw, InverseLeadsBack) {
  for (double h = 0.1 * um; h < 17.5 * um; h += 0.1 * um) EXPECT_NEAR(published.height_m(published.grey(h)), h, 1e-15);
  EXPECT_EQ(published.grey(0), 0);
  EXPECT_EQ(published.height_m(published.threshold() * (1 - 1e-9)), 0);
  EXPECT_NEAR(published.height_m(published.threshold() * (1 + 1e-9)), 0, 1e-12);
}

// With the published numbers no grey makes a whole layer of 18 um.
TEST(GrowthLaw, WhiteDoesNotReachThePublishedLayer) {
  EXPECT_NEAR(published.height_m(1) / um, 17.812, 0.001);
  EXPECT_GT(published.grey(18 * um), 1.01);
}

TEST(GrowthLaw, SlopesAreDifferences) {
  const double steps[3] = {1e-4 * um, 1e-4 * um, 1e-6};
  for (const double grey : {0.2, 0.5, 0.9}) {
    const std::array<double, 3> s = published.slopes(grey);
    for (int k = 0; k < 3; ++k) {
      GrowthLaw above = published, below = published;
      double* const number[2] = {k == 0   ? &above.alpha_m
                                 : k == 1 ? &above.beta_m
                                          : &above.gamma,
                                 k == 0   ? &below.alpha_m
                                 : k == 1 ? &below.beta_m
                                          : &below.gamma};
      *number[0] += steps[k], *number[1] -= steps[k];
      const double difference = (above.height_m(grey) - below.height_m(grey)) / (2 * steps[k]);
      EXPECT_NEAR(s[static_cast<std::size_t>(k)], difference, 1e-5 * std::abs(difference));
    }
  }
}

// A gradient of `levels` greys; heights have noise of their own, and each print an offset and a tilt.
PrintedGradient printed(const GrowthLaw& law, std::size_t levels, std::size_t repetitions, std::uint64_t seed,
                        double bent_m = 0) {
  Random random(77, seed);
  PrintedGradient p;
  for (std::size_t i = 0; i < levels; ++i) p.greys.push_back(static_cast<double>(i + 1) / static_cast<double>(levels));
  for (std::size_t r = 0; r < repetitions; ++r) {
    const double offset = 0.3 * um * random.normal(), tilt = 0.3 * um * random.normal();
    std::vector<double>& heights = p.repetitions_m.emplace_back();
    for (const double grey : p.greys) {
      const double h = law.height_m(grey) + bent_m * std::sin(3 * std::acos(-1.0) * grey);
      heights.push_back(h + offset + tilt * (grey - 0.5) + 0.4 * um * random.normal());
    }
  }
  return p;
}

GrowthLaw drawn(std::uint64_t seed) {
  Random random(78, seed);
  return {(14 + 8 * random.uniform()) * um, (7 + 6 * random.uniform()) * um, -0.05 + 0.1 * random.uniform()};
}

// 300 hidden printers: each of 900 intervals of 95 % covers with that chance; the numbers of one printer are
// correlated, so that the rate's standard deviation is at most 1.26 % (of 300): 93 to 97 % were asked, which a right
// program misses in 11 % of seeds at worst. The seed is fixed.
TEST(GrowthFit, IntervalsCoverHiddenPrinters) {
  int covered = 0, lacking = 0;
  for (std::uint64_t seed = 0; seed < 300; ++seed) {
    const GrowthLaw truth = drawn(seed);
    const GrowthFit fit = fit_growth(printed(truth, 32, 36, seed), "test");
    const double q = stats::student_quantile(0.975, fit.degrees);
    const std::array<double, 3> sigma = fit.sigma();
    covered += std::abs(fit.law.alpha_m - truth.alpha_m) < q * sigma[0];
    covered += std::abs(fit.law.beta_m - truth.beta_m) < q * sigma[1];
    covered += std::abs(fit.law.gamma - truth.gamma) < q * sigma[2];
    lacking += fit.lack_of_fit_p < 0.05;
  }
  EXPECT_GE(covered, 837);  // 93 %
  EXPECT_LE(covered, 873);  // 97 %
  // Of 300 at 5 %: 15; more than 25 in 0.8 % of seeds.
  EXPECT_LE(lacking, 25);
}

// One per cent of the layer, bent as no logarithm is.
TEST(GrowthFit, SaysWhereTheLawFails) {
  int lacking = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    lacking += fit_growth(printed(published, 32, 36, seed, 0.4 * um), "test").lack_of_fit_p < 0.05;
  EXPECT_GE(lacking, 19);
}

// The law and the table correct a gradient: heights asked for in even steps come out in even steps.
TEST(GrowthFit, CorrectedGradientIsLinear) {
  const GrowthFit fit = fit_growth(printed(published, 64, 36, 5), "test");
  for (double h = 2 * um; h < 17 * um; h += 0.5 * um) {
    EXPECT_NEAR(published.height_m(fit.law.grey(h)), h, 0.18 * um);  // 1 % of a layer
    ASSERT_TRUE(fit.table.grey(h).has_value());
    EXPECT_NEAR(published.height_m(*fit.table.grey(h)), h, 0.36 * um);
  }
}

TEST(GrowthTable, RisesAndLeadsBack) {
  const std::vector<double> weights(6, 1.0);
  const GrowthTable table({0, 0.2, 0.4, 0.6, 0.8, 1}, {0, 0, 5 * um, 4 * um, 9 * um, 12 * um}, weights);
  EXPECT_NEAR(table.heights_m()[2], 4.5 * um, 1e-15);
  double last = -1;
  for (double grey = 0; grey <= 1; grey += 0.001) {
    EXPECT_GE(table.height_m(grey), last - 1e-18);
    last = table.height_m(grey);
  }
  for (double h = 0.1 * um; h < 12 * um; h += 0.3 * um) EXPECT_NEAR(table.height_m(*table.grey(h)), h, 1e-13);
  EXPECT_FALSE(table.grey(12.1 * um).has_value());
  EXPECT_EQ(*table.grey(0), 0);
}

TEST(GrowthFit, BadGradientsAreRefused) {
  const auto refused = [](PrintedGradient p) {
    try {
      fit_growth(p, "print.csv");
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), Exit::data);
      return std::string(e.what());
    }
    return std::string();
  };
  const PrintedGradient good = printed(published, 16, 8, 1);
  PrintedGradient p = good;
  p.greys.resize(4);
  EXPECT_NE(refused(p).find("has 4 grey values"), std::string::npos);
  p = good;
  std::swap(p.greys[3], p.greys[4]);
  EXPECT_NE(refused(p).find("grey value 5"), std::string::npos);
  p = good;
  p.repetitions_m.resize(2);
  EXPECT_NE(refused(p).find("printed 2 times"), std::string::npos);
  p = good;
  p.repetitions_m[2].pop_back();
  EXPECT_NE(refused(p).find("repetition 3"), std::string::npos);
  p = good;
  for (auto& r : p.repetitions_m)
    for (double& h : r) h = 0;
  EXPECT_NE(refused(p).find("grew at 0"), std::string::npos);
  p = good;
  for (auto& r : p.repetitions_m) std::reverse(r.begin(), r.end());
  EXPECT_FALSE(refused(p).empty());
}

}  // namespace
}  // namespace gonio::print
