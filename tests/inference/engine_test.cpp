// The engine on linear problems whose truth is known. Statistical claims use fixed seeds; the stated false-alarm rate
// of a test is the chance that a correct engine would fail it for fresh seeds.
#include "explain/engine.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "base/parallel.h"
#include "inference/judgement.h"
#include "inference/toy_problem.h"
#include "stats/distributions.h"

namespace gonio::explain::tests {
namespace {

Options quick(std::uint64_t seed) {
  Options o;
  o.draws = 499;
  o.negative_controls = 24;
  o.seed = seed;
  return o;
}

std::vector<std::string> names(const Problem& problem, const Explanation& e) {
  std::vector<std::string> result;
  for (const std::size_t c : e.named) result.push_back(problem.candidates()[c].id());
  return result;
}

TEST(Engine, NamesNothingWhereNothingIsLeftOut) {
  int named = 0, alarms = 0;
  const int runs = 200;
  for (int run = 0; run < runs; ++run) {
    const ToyProblem problem(three_effects(), {{}, {}, 0.1, 0.05}, 1000 + run);
    const Explanation e = explain(problem, quick(run));
    named += e.verdict != Verdict::null;
    alarms += e.significant;
  }
  // Allowed: 1 % significant, of which few are named. Beyond 2 % resp. 5 % with less than 1e-3 chance.
  EXPECT_GT(stats::binomial_upper(alarms, runs, 0.02), 1e-3) << alarms;
  EXPECT_GT(stats::binomial_upper(named, runs, 0.02), 1e-3) << named;
}

TEST(Engine, NamesWhatIsThereAndItsIntervalCovers) {
  int found = 0, covered = 0;
  const int runs = 150;
  const double truth = 0.19;
  for (int run = 0; run < runs; ++run) {
    const ToyProblem problem(three_effects(), {{truth, 0, 0}, {}, 0.1, 0.05}, 5000 + run);
    const Explanation e = explain(problem, quick(run));
    if (names(problem, e) != std::vector<std::string>{"toy.square"}) continue;
    ++found;
    covered += e.estimates[0].lower_95 <= truth && truth <= e.estimates[0].upper_95;
  }
  EXPECT_GE(found, 0.95 * runs);  // three times the detection limit
  // 95 % intervals: outside 90-98 % of the found ones with less than 1e-3 chance at a true coverage of 95 %.
  EXPECT_GT(stats::binomial_upper(found - covered, found, 0.05), 1e-3) << covered << " of " << found;
  EXPECT_GE(covered, 0.9 * found);
}

TEST(Engine, TwoAtOnceAreBothNamed) {
  int both = 0;
  const int runs = 60;
  for (int run = 0; run < runs; ++run) {
    const ToyProblem problem(three_effects(), {{0.2, 0, 0.12}, {}, 0.1, 0.05}, 9000 + run);
    std::vector<std::string> found = names(problem, explain(problem, quick(run)));
    std::sort(found.begin(), found.end());
    both += found == std::vector<std::string>{"toy.square", "toy.wave"};
  }
  EXPECT_GE(both, 0.8 * runs);
}

TEST(Engine, IdenticalSignaturesAreNotToldApart) {
  std::vector<ToyEffect> effects = three_effects();
  effects.push_back({"toy.twin", [](double x, double) { return 2 * x * x; }});
  for (int run = 0; run < 20; ++run) {
    const ToyProblem problem(effects, {{0.25}, {}, 0.1, 0.0}, 300 + run);
    const Explanation e = explain(problem, quick(run));
    EXPECT_EQ(e.verdict, Verdict::ambiguous) << e.sentence;
    ASSERT_EQ(e.not_told_apart.size(), 1u);
    std::vector<std::size_t> set = e.not_told_apart[0];
    std::sort(set.begin(), set.end());
    EXPECT_EQ(set, (std::vector<std::size_t>{0, 3}));
  }
}

TEST(Engine, WhatTheLibraryLacksIsUnknownAndLocated) {
  int unknown = 0, located = 0;
  const int runs = 40;
  for (int run = 0; run < runs; ++run) {
    ToyProblem::Truth truth{{}, [](double, double z) { return 0.2 * std::cos(5 * z); }, 0.1, 0.02};
    const ToyProblem problem(three_effects(), truth, 700 + run);
    const Explanation e = explain(problem, quick(run));
    unknown += e.verdict == Verdict::unknown;
    located += !e.conditions.empty() && e.conditions[0].name == "z";
  }
  EXPECT_GE(unknown, 0.95 * runs);
  EXPECT_GE(located, 0.95 * runs);
}

class Erring : public ToyProblem {
 public:
  using ToyProblem::ToyProblem;
  inference::Simulator simulator() const override { return inference::Simulator::errs; }
};

// What no set repairs is outside the library where simulators are exact; where they err, some of it the library has.
TEST(Engine, UnknownIsNoProofThatTheLibraryLacksIt) {
  const ToyProblem::Truth truth{{}, [](double, double z) { return 0.2 * std::cos(5 * z); }, 0.1, 0.02};
  const ToyProblem exact(three_effects(), truth, 700);
  const Erring errs(three_effects(), truth, 700);
  const auto none_of_these = [](const Explanation& e) {
    return std::ranges::find(e.weighed, Explanation::Weighed::Kind::outside, &Explanation::Weighed::kind)->probability;
  };
  const Explanation sure = explain(exact, quick(0)), less = explain(errs, quick(0));
  ASSERT_EQ(sure.verdict, Verdict::unknown);
  ASSERT_EQ(less.verdict, Verdict::unknown);
  EXPECT_NEAR(sure.probability, none_of_these(sure), 1e-12);
  EXPECT_NEAR(less.probability, inference::share_outside(inference::Simulator::errs) * none_of_these(less), 1e-12);
  EXPECT_LT(less.probability, sure.probability);
}

TEST(Engine, SignificantIsNotImportant) {
  const ToyProblem problem(three_effects(), {{0.02, 0, 0}, {}, 0.1, 0.0}, 42, 10, 4000, 1);
  const Explanation e = explain(problem, quick(1));
  EXPECT_TRUE(e.significant);
  EXPECT_FALSE(e.important);
  EXPECT_EQ(e.verdict, Verdict::null) << e.sentence;
}

// Where noise is known to be of single readings, what scatters three times as much is a mismatch that matters, though
// nothing in the library and no curve repairs it; a small effect beside it does not make it nothing. Where blocks may
// share more than is stated, it is noise.
// Noise of a third of what is there, stated by a problem that knows it, or does not.
class Scattering : public ToyProblem {
 public:
  Scattering(bool known, double amplitude)
      : ToyProblem(three_effects(), {{amplitude, 0, 0}, {}, 0.1, 0.0}, 42, 10, 4000, 1), known_(known) {
    for (double& s : observations_.sigma) s /= 3;
  }
  bool scatter_is_mismatch() const override { return known_; }

 private:
  bool known_;
};

TEST(Engine, WhatScattersBeyondKnownNoiseIsNotNothing) {
  const Explanation known = explain(Scattering(true, 0.02), quick(1)),
                    unknown = explain(Scattering(false, 0.02), quick(1));
  EXPECT_EQ(known.verdict, Verdict::unknown) << known.sentence;
  EXPECT_TRUE(known.important);
  EXPECT_EQ(unknown.verdict, Verdict::null) << unknown.sentence;
}

TEST(Engine, ANameSaysWhatScattersBesideIt) {
  const Explanation known = explain(Scattering(true, 0.2), quick(1)),
                    unknown = explain(Scattering(false, 0.2), quick(1));
  ASSERT_FALSE(known.named.empty()) << known.sentence;
  EXPECT_NE(known.sentence.find("It is not all: what is left scatters by"), std::string::npos) << known.sentence;
  ASSERT_FALSE(unknown.named.empty()) << unknown.sentence;
  EXPECT_EQ(unknown.sentence.find("It is not all"), std::string::npos) << unknown.sentence;
}

TEST(Engine, SameSeedSameAnswerWhateverTheThreads) {
  const ToyProblem problem(three_effects(), {{0.2, 0, 0.1}, {}, 0.1, 0.05}, 77);
  set_threads(1);
  const Explanation one = explain(problem, quick(3));
  set_threads(2);
  const Explanation two = explain(problem, quick(3));
  set_threads(0);
  EXPECT_EQ(one.values, two.values);
  EXPECT_EQ(one.covariance, two.covariance);
  EXPECT_EQ(one.global_p, two.global_p);
  EXPECT_EQ(one.sentence, two.sentence);
}

}  // namespace
}  // namespace gonio::explain::tests
