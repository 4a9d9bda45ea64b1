// Structure that no mechanism of the library has: along one condition (serial correlation) and in a product of two
// (interaction). Found where it was put in, and as rare as stated where there is none.
#include <gtest/gtest.h>

#include <cmath>

#include "inference/fit.h"
#include "inference/interaction.h"
#include "inference/nonlinear_toy.h"
#include "inference/serial_correlation.h"

namespace gonio::explain::tests {
namespace {

constexpr double noise = 0.1;

struct Fitted {
  NonlinearToy problem;
  System system;
  Fit base;
  Fitted(std::function<double(double x, double z)> outside, std::uint64_t seed)
      : problem({}, {}, {std::move(outside), noise, 0}, seed),
        system(problem, 1),
        base(fit(system, std::vector<double>(problem.parameters().size(), 0.0), problem.base())) {}
};

// Of 300 draws at 5 % more than 33 or fewer than 2 come up by chance less than once in ten thousand times, were they
// independent of the two conditions' correction.
constexpr int draws = 300, most = 33, fewest = 2;

TEST(SerialCorrelation, IsAsRareAsStatedWhereThereIsNone) {
  int below = 0;
  for (int seed = 0; seed < draws; ++seed) {
    const Fitted f({}, static_cast<std::uint64_t>(seed));
    below += serial_correlation(f.system, f.base.values)->p < 0.05;
  }
  EXPECT_LE(below, most);
  EXPECT_GE(below, fewest);
}

TEST(SerialCorrelation, SeesARippleAndItsPower) {
  const double amplitude = 0.15;
  const Fitted f([=](double x, double) { return amplitude * std::sin(25 * x); }, 3);
  const auto found = serial_correlation(f.system, f.base.values);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->condition, 0U);
  EXPECT_LT(found->p, 1e-6);
  const double power = amplitude * amplitude / 2 / (noise * noise);
  EXPECT_NEAR(found->power, power, 0.3 * power);
  // Of the score's rms, sqrt(1 + power), this would remove so much.
  EXPECT_NEAR(found->effect, 1 - std::sqrt(1 / (1 + power)), 0.1);
}

TEST(Interaction, IsAsRareAsStatedWhereThereIsNone) {
  int below = 0;
  for (int seed = 0; seed < draws; ++seed) {
    const Fitted f({}, static_cast<std::uint64_t>(1000 + seed));
    below += interaction(f.system, f.base)->p < 0.05;
  }
  EXPECT_LE(below, most);
  EXPECT_GE(below, fewest);
}

TEST(Interaction, SeesAProductThatIsFlatOverEitherCondition) {
  const Fitted f([](double x, double z) { return 0.2 * x * z; }, 5);
  const auto found = interaction(f.system, f.base);
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(std::min(found->first, found->second), 0U);
  EXPECT_EQ(std::max(found->first, found->second), 1U);
  EXPECT_LT(found->p, 1e-6);
  const double power = 0.2 * 0.2 / 9 / (noise * noise);  // x and z uniform in (-1, 1): variance 1/3 each
  EXPECT_NEAR(found->power, power, 0.4 * power);
}

TEST(Interaction, IsBlindToACurveOverOneCondition) {
  const Fitted f([](double x, double) { return 0.3 * x * x; }, 7);
  EXPECT_GT(interaction(f.system, f.base)->p, 0.001);
}

}  // namespace
}  // namespace gonio::explain::tests
