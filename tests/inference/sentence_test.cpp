// Sentences agree with their figures: what says "no mismatch beyond noise" has residuals as large as the noise, and
// what scatters more than its stated noise without structure is told as that, in every verdict.
#include "inference/sentence.h"

#include <gmock/gmock.h>

#include "explain/engine.h"
#include "inference/toy_problem.h"

namespace gonio::explain::tests {
namespace {

using testing::HasSubstr;
using testing::Not;

Explanation explained(const ToyProblem& problem) {
  Options options;
  options.draws = 199;
  options.negative_controls = 4;
  return explain(problem, options);
}

// Noise five times as large as it is stated.
class UnderstatedNoise : public ToyProblem {
 public:
  explicit UnderstatedNoise(std::uint64_t seed) : ToyProblem(three_effects(), {{}, {}, 0.1, 0.02}, seed) {
    for (double& sigma : observations_.sigma) sigma *= 0.2;
  }
};

// Blocks that scatter by five times the stated noise hold no structure: signs of whole blocks do not know how large
// the noise is, the sentence has to.
TEST(Sentence, ScatterWithoutStructureIsNotCalledNoise) {
  const ToyProblem calm(three_effects(), {{}, {}, 0.1, 0.02}, 3);
  const UnderstatedNoise rough(3);
  const Explanation quiet = explained(calm), loud = explained(rough);
  ASSERT_EQ(quiet.verdict, Verdict::null);
  ASSERT_EQ(loud.verdict, Verdict::null);
  EXPECT_FALSE(loud.significant);
  EXPECT_THAT(quiet.sentence, testing::StartsWith("No mismatch beyond noise (p = "));
  EXPECT_THAT(loud.sentence, testing::StartsWith("No structure is told from scatter (p = "));
  EXPECT_THAT(loud.sentence, HasSubstr("times as much as the noise that was taken for them"));
}

// Every verdict at every size of the residuals.
TEST(Sentence, NoNullSaysThatTheMisfitExceedsItsNoise) {
  const ToyProblem problem(three_effects(), {{}, {}, 0.1, 0.02}, 5);
  const Explanation found = explained(problem);
  for (const Verdict verdict : {Verdict::null, Verdict::named, Verdict::ambiguous, Verdict::unknown})
    for (const bool significant : {false, true})
      for (const double times : {0.5, 1.0, 1.4, 1.7, 4.44, 60.0}) {
        SCOPED_TRACE(verdict_name(verdict) + (significant ? ", significant, " : ", ") + std::to_string(times));
        Explanation e = found;
        e.verdict = verdict;
        e.significant = significant || verdict != Verdict::null;
        e.named.clear();
        if (verdict == Verdict::named || verdict == Verdict::ambiguous) e.named = {0};
        if (verdict == Verdict::ambiguous) e.not_told_apart = {{0, 1}};
        for (double& r : e.residual_before) r *= times;
        e.held_out_before *= times;
        write_sentence(problem, e);
        if (times > 1.6) {
          EXPECT_THAT(e.sentence, Not(HasSubstr("No mismatch beyond noise")));
        }
        EXPECT_THAT(e.sentence, Not(HasSubstr("times its noise")));
        const bool quiet = verdict == Verdict::null && !significant;
        EXPECT_EQ(e.sentence.starts_with("No structure is told from scatter"), quiet && times > 1.6) << e.sentence;
        EXPECT_EQ(e.sentence.starts_with("No mismatch beyond noise"), quiet && times < 1.5) << e.sentence;
      }
}

// The slope is 0.7, and must not fall below one.
class HeldSlope : public ToyProblem {
 public:
  explicit HeldSlope(double start, std::optional<double> prior_sigma = {})
      : ToyProblem(three_effects(), {{}, {}, 0.1, 0.02}, 6) {
    parameters_[0].lower = 1;
    parameters_[0].start = start;
    parameters_[0].prior_sigma = prior_sigma;
  }
};

// A bound that the problem itself begins at, or that its prior reaches, is no limit of what is plausible.
TEST(Sentence, LimitsOfThePlausibleComeFirst) {
  EXPECT_THAT(explained(HeldSlope(1.5)).sentence, testing::StartsWith("The base model fits only at the limit"));
  EXPECT_THAT(explained(HeldSlope(1)).sentence, Not(HasSubstr("at the limit")));
  EXPECT_THAT(explained(HeldSlope(1.5, 0.4)).sentence, Not(HasSubstr("at the limit")));
}

// Files in the wrong places are said before anything else.
TEST(Sentence, MisplacedFilesComeFirst) {
  const ToyProblem problem(three_effects(), {{}, {}, 0.1, 0.02}, 5);
  Explanation e = explained(problem);
  e.verdict = Verdict::unknown;
  e.misplaced = {{{"a", "b", 0.48, 0.03}}, "The file of image `a` fits what `b` should show."};
  write_sentence(problem, e);
  EXPECT_THAT(e.sentence, testing::StartsWith("The file of image `a` fits what `b` should show. No physics is asked"));
  EXPECT_THAT(e.next_measurement, testing::StartsWith("Put the files in their places"));
}

}  // namespace
}  // namespace gonio::explain::tests
