// The stated probability as a function of what is known: no engine, no data.
#include "inference/probability.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace gonio::inference {
namespace {

using testing::ElementsAre;

// A set that repairs nearly all, with one number of usual size, that leaves nothing and whose effect is plain.
Member good() {
  Member m;
  m.statistics = {.missed = 0.01, .numbers = 1, .size = 0.3, .weakest = 6, .times = 2};
  return m;
}
std::vector<Member> against(const std::vector<Member>& sets, double mismatch = 6) {
  Member nothing{Member::Kind::nothing, {}};
  nothing.statistics.mismatch = mismatch, nothing.statistics.largest = 2;
  std::vector<Member> all = {nothing, {Member::Kind::outside, {}}};
  all.insert(all.end(), sets.begin(), sets.end());
  return all;
}
double first(const std::vector<Member>& sets) {
  return probabilities(against(sets)).at(2);
}

TEST(Probability, AddsUpToOneAndWhatIsPlainIsSure) {
  const std::vector<double> p = probabilities(against({good()}));
  EXPECT_NEAR(std::accumulate(p.begin(), p.end(), 0.0), 1, 1e-12);
  EXPECT_GT(p[2], 0.9);
  EXPECT_LT(p[0], 0.02);
}

// Everything that speaks against a set takes from it, and never to its favour.
TEST(Probability, EveryStatisticSpeaksInOneDirection) {
  for (const LogitTerm& t : logit_terms()) {
    EXPECT_GE(t.weight * t.sign, 0) << t.name;
    EXPECT_GE(t.where_it_errs * t.sign, 0) << t.name;
  }
  const double plain = first({good()});
  const auto worse = [&](double Statistics::*which, double value) {
    Member m = good();
    m.statistics.*which = value;
    return first({m});
  };
  EXPECT_LE(worse(&Statistics::missed, 0.3), plain);
  EXPECT_LE(worse(&Statistics::own, 0.3), plain);
  EXPECT_LE(worse(&Statistics::any, 0.4), plain);
  EXPECT_LE(worse(&Statistics::curve, 0.3), plain);
  EXPECT_LE(worse(&Statistics::numbers, 9), plain);
  EXPECT_LE(worse(&Statistics::size, 5), plain);
  EXPECT_LE(worse(&Statistics::controls, 0.3), plain);
  EXPECT_LE(worse(&Statistics::weakest, 2), plain);
  EXPECT_LE(worse(&Statistics::times, 0.1), plain);
}

// Nine numbers of thirty times their usual size that a free curve outdoes, beside one plain number half a standard
// error behind: a power law of 0.88 that three lamps 60 mm elsewhere had explained.
TEST(Probability, NineNumbersYieldToOne) {
  Member nine = good(), one = good();
  nine.statistics.numbers = 9, nine.statistics.size = std::log1p(144), nine.statistics.curve = 0.2;
  one.statistics.behind = 0.5, one.statistics.missed = 0.05;
  const std::vector<double> p = probabilities(against({nine, one}));
  EXPECT_GT(p[3], 5 * p[2]);
}

// Dust is surely there, and a fourth of what matters.
TEST(Probability, WhatIsSurelyThereAndSmallIsNothingThatMatters) {
  Member nothing{Member::Kind::nothing, {}};
  nothing.statistics.mismatch = 12, nothing.statistics.largest = std::log(0.27);
  std::vector<Member> members{nothing, {Member::Kind::outside, {}}};
  EXPECT_EQ(answer(members, probabilities(members), 0.9).kind, Answer::Kind::nothing);
  members[1].statistics.times = -1;  // no condition carries any that matters
  const Answer a = answer(members, probabilities(members), 0.9);
  EXPECT_EQ(a.kind, Answer::Kind::nothing);
  EXPECT_NEAR(a.probability, 1, 1e-12);
}

// What is too small to matter is nothing that matters, but not where readings stand out that it does not repair.
TEST(Probability, SmallSetsDoNotRepairReadingsThatStandOut) {
  Member small = good();
  small.statistics.times = -0.5;
  std::vector<Member> members = against({small});
  members[1].statistics.times = -1;
  EXPECT_NEAR(rest_of(members, {0.1, 0.2, 0.7}).nothing, 1, 1e-12);
  members[1].statistics.times = members[1].statistics.outlying = 0.5;
  EXPECT_NEAR(rest_of(members, {0.1, 0.2, 0.7}).nothing, 0.1, 1e-12);
  EXPECT_NEAR(rest_of(members, {0.1, 0.2, 0.7}).outside, 0.9, 1e-12);
  EXPECT_EQ(answer(members, {0.1, 0.2, 0.7}, 0.9).kind, Answer::Kind::outside);
}

TEST(Probability, TwinsShareIt) {
  const std::vector<Member> members = against({good(), good()});
  const std::vector<double> p = probabilities(members);
  EXPECT_NEAR(p[2], p[3], 1e-12);
  const Answer a = answer(members, p, 0.9);
  EXPECT_EQ(a.kind, Answer::Kind::sets);
  EXPECT_EQ(a.sets.size(), 2u);
  EXPECT_NEAR(a.probability, p[2] + p[3], 1e-12);
}

TEST(Answer, ListsNothingThatIsHardlyPossible) {
  const std::vector<Member> members = against({good(), good()});
  const Answer one = answer(members, {0.05, 0.052, 0.89, 0.008}, 0.9);
  EXPECT_THAT(one.sets, ElementsAre(2));
  EXPECT_EQ(one.probability, 0.89);
  EXPECT_THAT(answer(members, {0.02, 0.03, 0.85, 0.1}, 0.9).sets, ElementsAre(2, 3));
}

TEST(Answer, IsOneWhereItIsSureAndSeveralWhereTheyAreTogether) {
  const std::vector<Member> m = against({good(), good(), good(), good()});
  const auto sets = [&](const std::vector<double>& p, double sure) { return answer(m, p, sure).sets; };
  EXPECT_THAT(sets({0.01, 0.04, 0.93, 0.02, 0, 0}, 0.9), ElementsAre(2));
  EXPECT_THAT(sets({0.01, 0.04, 0.93, 0.02, 0, 0}, 0.95), ElementsAre(2, 3));
  EXPECT_THAT(sets({0.01, 0.04, 0.2, 0.6, 0.15, 0}, 0.9), ElementsAre(3, 2, 4));
  // Three at most, as long as they are likelier than not.
  EXPECT_THAT(sets({0.02, 0.2, 0.21, 0.2, 0.19, 0.18}, 0.9), ElementsAre(2, 3, 4));
  EXPECT_EQ(answer(m, {0.1, 0.6, 0.2, 0.1, 0, 0}, 0.9).kind, Answer::Kind::outside);
  EXPECT_NEAR(answer(m, {0.1, 0.6, 0.2, 0.1, 0, 0}, 0.9).probability, 0.6, 1e-12);
  EXPECT_EQ(answer(m, {0.6, 0.1, 0.2, 0.1, 0, 0}, 0.9).kind, Answer::Kind::nothing);
}

// A vignette beside which a dent imitates now this and now that: no three sets are likelier than not, and still it is
// neither nothing nor outside.
TEST(Answer, IsAmongTheSetsWhereTheseAreLikelierThanNotTogether) {
  const std::vector<Member> m = against({good(), good(), good(), good(), good(), good(), good()});
  const Answer a = answer(m, {0.01, 0.04, 0.16, 0.15, 0.14, 0.13, 0.13, 0.12, 0.12}, 0.9);
  EXPECT_EQ(a.kind, Answer::Kind::sets);
  EXPECT_THAT(a.sets, ElementsAre(2, 3, 4));
  EXPECT_NEAR(a.probability, 0.45, 1e-12);
}

TEST(Probability, NamesOfStatisticsAreUnique) {
  std::vector<std::string> names;
  for (const Statistic& s : statistics()) names.emplace_back(s.name);
  std::sort(names.begin(), names.end());
  EXPECT_EQ(std::adjacent_find(names.begin(), names.end()), names.end());
  EXPECT_EQ(names.size(), 16u);
}

}  // namespace
}  // namespace gonio::inference
