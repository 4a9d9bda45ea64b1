// The engine on linear problems whose truth is known. Statistical claims use fixed seeds; the stated false-alarm rate of a test is the
// chance that a correct engine would fail it for fresh seeds.
#include "explain/engine.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "explain/toy_problem.h"
#include "stats/distributions.h"

namespace gonio::explain::tests {
namespace {

Options quick(std::uint64_t seed) {
  Options o;
  o.draws = 499;
  o.dummies = 8;
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
  RecordProperty("alarms", alarms);
  RecordProperty("named", named);
  std::cout << "alarms " << alarms << " named " << named << "\n";
}

TEST(Engine, NamesWhatIsThereAndItsIntervalCovers) {
  int found = 0, covered = 0;
  const int runs = 150;
  const double truth = 0.06;
  for (int run = 0; run < runs; ++run) {
    const ToyProblem problem(three_effects(), {{truth, 0, 0}, {}, 0.1, 0.05}, 5000 + run);
    const Explanation e = explain(problem, quick(run));
    if (names(problem, e) != std::vector<std::string>{"toy.square"}) continue;
    ++found;
    covered += e.estimates[0].lower_95 <= truth && truth <= e.estimates[0].upper_95;
  }
  std::cout << "found " << found << " covered " << covered << "\n";
  EXPECT_GE(found, 0.9 * runs);
}

}  // namespace
}  // namespace gonio::explain::tests
