// Waves that begin anew in every group: found with their period and said as such, as rare as stated where there are
// none; and what the words are where no condition carries the mismatch.
#include "inference/own_phase.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "inference/fit.h"
#include "inference/nonlinear_toy.h"
#include "inference/sentence.h"
#include "inference/wording.h"

namespace gonio::explain::tests {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr double noise = 0.1, period = 0.23;

class Bands : public NonlinearToy {
 public:
  Bands(double amplitude, std::uint64_t seed) : NonlinearToy({}, {}, {{}, noise, 0.02}, seed, {8, 40, 3}) {
    Random random(seed, 21);
    observations_.conditions[1].within_groups = true;
    for (std::size_t g = 0; g < observations_.groups(); ++g) {
      const double phase = random.uniform(0, 2 * std::numbers::pi);
      for (std::size_t i = observations_.first[g]; i < observations_.first[g + 1]; ++i)
        observations_.value[i] +=
            amplitude * std::sin(2 * std::numbers::pi * observations_.conditions[1].values[i] / period + phase);
    }
  }
};

std::vector<OwnPhase> phases_in(const Bands& problem) {
  const System system(problem, 1);
  const Fit base = fit(system, std::vector<double>(problem.parameters().size(), 0.0), problem.base());
  return own_phases(system, base.values);
}

// Of 200 draws at 5 % more than 25 come up by chance less than once in a thousand times.
TEST(OwnPhase, IsNotFoundMoreOftenThanStatedWhereThereIsNone) {
  int below = 0;
  for (std::uint64_t seed = 0; seed < 200; ++seed) {
    const std::vector<OwnPhase> found = phases_in(Bands(0, seed));
    ASSERT_EQ(found.size(), 1u);
    below += found[0].p < 0.05;
  }
  EXPECT_LE(below, 25);
}

TEST(OwnPhase, FindsThePeriod) {
  for (std::uint64_t seed = 0; seed < 10; ++seed) {
    const std::vector<OwnPhase> found = phases_in(Bands(0.08, seed));
    ASSERT_EQ(found.size(), 1u);
    EXPECT_EQ(found[0].condition, 1u);
    EXPECT_NEAR(found[0].period, period, 0.01) << seed;
    EXPECT_LT(found[0].p, 1e-4) << seed;
  }
}

TEST(OwnPhase, IsSaidAsBandsThatBeginAnew) {
  const Bands problem(0.12, 3);
  Options options;
  options.draws = 199;
  options.negative_controls = 4;
  const Explanation e = explain(problem, options);
  EXPECT_EQ(e.verdict, Verdict::unknown) << e.sentence;
  ASSERT_FALSE(e.conditions.empty());
  EXPECT_EQ(e.conditions[0].name, "z");
  EXPECT_NEAR(e.conditions[0].period, period, 0.01);
  EXPECT_GT(e.conditions[0].share, 0.7);
  EXPECT_THAT(e.sentence, HasSubstr("in bands along the z, 0.23 m from one to the next, begun anew in every group"));
}

// One rule and one constant, in the sentence of every verdict.
TEST(Where, IsNotClaimedWhereTheBestConditionHoldsLittle) {
  const Bands problem(0.12, 3);
  Options options;
  options.draws = 199;
  options.negative_controls = 4;
  Explanation e = explain(problem, options);
  e.outside.reset();
  for (LocatedCondition& c : e.conditions) c.share = std::min(c.share, 0.9 * telling_share), c.period = 0;
  write_sentence(problem, e);
  EXPECT_THAT(e.sentence, HasSubstr("but no condition carries it: the most telling, the z, holds 18 % of the excess"));
  EXPECT_THAT(e.sentence, Not(HasSubstr("structured over")));
  EXPECT_THAT(e.next_measurement, Not(HasSubstr("that vary the z")));
  e.conditions[0].share = 1.1 * telling_share;
  write_sentence(problem, e);
  EXPECT_THAT(e.sentence, HasSubstr("structured over the z"));
}

}  // namespace
}  // namespace gonio::explain::tests
