// How often an answer comes out of parts of the recordings (inference/stability.h).
#include "inference/stability.h"

#include <gtest/gtest.h>

#include <set>

#include "inference/engine.h"
#include "inference/nonlinear_toy.h"

namespace gonio::explain::tests {
namespace {

using inference::stability;

class Recordings : public NonlinearToy {
 public:
  explicit Recordings(std::size_t groups) : NonlinearToy(library(), {}, {{}, 0.1, 0}, 1, {groups, 4, 2}) {}
};

TEST(Stability, PartsAreThreeQuartersAllDifferentAndTheSameForOneSeed) {
  const Recordings problem(8);
  std::set<std::vector<std::size_t>> parts;
  const auto ask = [&](const std::vector<std::size_t>& left_out) {
    EXPECT_EQ(left_out.size(), 2u);
    EXPECT_TRUE(std::is_sorted(left_out.begin(), left_out.end()));
    EXPECT_TRUE(parts.insert(left_out).second);
    return Explanation{};
  };
  const Stability s = stability(problem, 20, 7, ask);
  EXPECT_EQ(s.draws, 20u);
  EXPECT_EQ(s.groups, 6u);
  EXPECT_EQ(s.same(problem, Verdict::null, {}), 20u);
  const std::set<std::vector<std::size_t>> first = std::exchange(parts, {});
  stability(problem, 20, 7, ask);
  EXPECT_EQ(parts, first);
}

TEST(Stability, FewGroupsHaveFewParts) {
  std::size_t asked = 0;
  const auto ask = [&](const std::vector<std::size_t>&) { return ++asked, Explanation{}; };
  EXPECT_EQ(stability(Recordings(5), 20, 1, ask).draws, 5u);
  EXPECT_EQ(asked, 5u);
  EXPECT_EQ(stability(Recordings(3), 20, 1, ask).draws, 0u);
}

// Two forms of one mechanism on the same things are one answer.
TEST(Stability, FormsOfAMechanismAreOneAnswer) {
  class TwoForms : public Recordings {
   public:
    TwoForms() : Recordings(8) { candidates_.push_back(candidates_[0]), candidates_.back().finer = true; }
  };
  const TwoForms problem;
  const std::size_t other = problem.candidates().size() - 1;
  std::size_t asked = 0;
  const Stability s = stability(problem, 10, 1, [&](const std::vector<std::size_t>&) {
    Explanation e;
    e.verdict = Verdict::named, e.named = {++asked % 2 == 0 ? other : 0};
    return e;
  });
  ASSERT_EQ(s.answers.size(), 1u);
  EXPECT_EQ(s.same(problem, Verdict::named, {other}), 10u);
  EXPECT_EQ(s.same(problem, Verdict::named, {1}), 0u);
}

// A name that hangs on one recording comes out where that one takes part, and only there.
TEST(Stability, CountsWhatComesOut) {
  const Recordings problem(8);
  const Stability s = stability(problem, 28, 1, [](const std::vector<std::size_t>& left_out) {
    Explanation e;
    const bool there = std::find(left_out.begin(), left_out.end(), 3u) == left_out.end();
    e.verdict = there ? Verdict::named : Verdict::null;
    if (there) e.named = {2, 0};
    return e;
  });
  ASSERT_EQ(s.draws, 28u);  // all parts of six of eight
  EXPECT_EQ(s.same(problem, Verdict::named, {0, 2}), 21u);
  EXPECT_EQ(s.same(problem, Verdict::null, {}), 7u);
  EXPECT_EQ(s.same(problem, Verdict::named, {0}), 0u);
  EXPECT_EQ(s.answers.at(0).times, 21u);
}

// A bend, and two groups whose readings belong to something else where `by` is not zero.
class Spoilt : public NonlinearToy {
 public:
  explicit Spoilt(double by) : NonlinearToy(library(), {{1.5}}, {{}, 0.1, 0}, 3, {8, 40, 2}) {
    for (const std::size_t group : {1u, 4u})
      for (std::size_t i = observations_.first[group]; i < observations_.first[group + 1]; ++i)
        observations_.value[i] += by * std::sin(37.0 * at(0, i));
  }
};

TEST(Stability, TheEngineLeavesGroupsOut) {
  const Explanation clean = explain(Spoilt(0), {}, {1, 4}), spoilt = explain(Spoilt(40), {}, {1, 4});
  ASSERT_FALSE(clean.named.empty()) << clean.sentence;
  EXPECT_EQ(clean.named[0], 0u);
  EXPECT_EQ(spoilt.named, clean.named);
  EXPECT_EQ(spoilt.held_out_after, clean.held_out_after);
}

}  // namespace
}  // namespace gonio::explain::tests
