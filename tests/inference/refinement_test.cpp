// Estimates where predict() stands for a slower simulation: after the bias is taken into account they hold the truth.
#include <gtest/gtest.h>

#include <cmath>

#include "toy_problem.h"

namespace gonio::explain::tests {
namespace {

constexpr double truth = 0.5;

// The world has 8 % more of the square than predict() gives it; the exact simulation knows, but for its own scatter.
class Approximate final : public ToyProblem {
 public:
  enum class Knows { nothing, all, nonsense };
  Approximate(Knows knows, std::uint64_t seed)
      : ToyProblem(three_effects(), {{excess * truth, 0, 0}, {}, 0.05, 0}, seed), knows_(knows), seed_(seed) {}
  std::optional<inference::Bias> bias(std::span<const double> values,
                                      std::span<const std::size_t> candidates) const override {
    if (knows_ == Knows::nothing) return std::nullopt;
    ++asked;
    EXPECT_EQ(candidates.size(), 1u);
    const double p = values[candidates_[0].parameters[0]];
    Random random(seed_, 99);  // the same numbers at all values
    inference::Bias bias;
    for (std::size_t row = 0; row < observations_.rows(); ++row) {
      const double x = at(0, row), off = knows_ == Knows::all ? (excess - 1) * p * x * x : std::cos(20 * x);
      bias.value.push_back(off + scatter * random.normal());
      bias.variance.push_back(scatter * scatter);
    }
    return bias;
  }
  mutable int asked = 0;

 private:
  static constexpr double excess = 1.08, scatter = 0.03;
  Knows knows_;
  std::uint64_t seed_;
};

Options quick() {
  Options options;
  options.draws = 199;
  options.negative_controls = 4;
  return options;
}

TEST(Refinement, IntervalsHoldTheTruthOnceTheBiasIsKnown) {
  int hold = 0, hold_without = 0, named = 0;
  constexpr int worlds = 40;
  for (int k = 0; k < worlds; ++k) {
    const auto seed = static_cast<std::uint64_t>(k + 1);
    const Approximate exact(Approximate::Knows::all, seed), plain(Approximate::Knows::nothing, seed);
    const Explanation a = explain(exact, quick()), b = explain(plain, quick());
    ASSERT_EQ(a.estimates.size(), b.estimates.size());
    if (a.estimates.size() != 1) continue;
    ++named;
    EXPECT_EQ(exact.asked, 2);
    EXPECT_DOUBLE_EQ(a.values[a.estimates[0].parameter], a.estimates[0].value);
    hold += a.estimates[0].lower_95 <= truth && truth <= a.estimates[0].upper_95;
    hold_without += b.estimates[0].lower_95 <= truth && truth <= b.estimates[0].upper_95;
  }
  EXPECT_GE(named, worlds * 9 / 10);
  EXPECT_GE(hold, named * 85 / 100);  // 0.95 less three standard errors
  EXPECT_LE(hold_without, named / 2);
}

// What it scatters widens the interval; what fits the recordings worse than predict() is another simulation.
TEST(Refinement, ScatterIsCountedAndNonsenseIsNot) {
  const Explanation plain = explain(Approximate(Approximate::Knows::nothing, 3), quick()),
                    exact = explain(Approximate(Approximate::Knows::all, 3), quick()),
                    other = explain(Approximate(Approximate::Knows::nonsense, 3), quick());
  ASSERT_EQ(plain.estimates.size(), 1u);
  ASSERT_EQ(exact.estimates.size(), 1u);
  ASSERT_EQ(other.estimates.size(), 1u);
  EXPECT_GT(exact.estimates[0].sigma, plain.estimates[0].sigma);
  EXPECT_DOUBLE_EQ(other.estimates[0].value, plain.estimates[0].value);
  EXPECT_EQ(exact.residual_after, plain.residual_after);
}

}  // namespace
}  // namespace gonio::explain::tests
