// A slice of the sealed cases through the program itself, for every run of the tests: tables, which take a second each.
// All of them, and the other domains, are for scripts/prove. The programs are those of GONIO_BIN. Bounds are such that
// a program that reaches the figures of the proof fails with a chance below 1 in 1000, given beside each; seeds are
// fixed.
#include <gtest/gtest.h>

#include <algorithm>

#include "base/atomic_file.h"
#include "data.h"
#include "process.h"
#include "sealed/judge.h"
#include "sealed/worlds.h"
#include "stats/distributions.h"

namespace gonio::sealed {
namespace {

Judged asked(const Spec& spec) {
  const Case made = make_case(spec);
  tests::ScratchFolder folder;
  for (const auto& [name, bytes] : made.files) write_file(folder / name, bytes);
  const tests::Ended ended =
      tests::run({"explain", "recording.json", "-o", "out.json", "--out", "out", "--threads", "1"}, folder.path());
  EXPECT_LE(ended.status, 2) << ended.err;
  return {made.spec, made.truth, made.id, read_answer(folder.path(), made)};
}

// The first `most` cases of a domain that are of the kind.
std::vector<Judged> answers(const std::string& domain, Kind kind, std::size_t most) {
  std::vector<Judged> cases;
  for (const Spec& s : all_specs())
    if (s.domain == domain && s.kind == kind && cases.size() < most) cases.push_back(asked(s));
  return cases;
}

class SealedTables : public testing::TestWithParam<const char*> {};

// 2 % of wrong names are allowed: 3 or more of 8 come with a chance of 4e-4.
TEST_P(SealedTables, NothingIsNamedWhereNothingWasLeftOut) {
  EXPECT_LT(stats::binomial_upper(3, 8, 0.02), 1e-3);
  std::vector<Judged> cases = answers(GetParam(), Kind::null, 5);
  for (Judged& j : answers(GetParam(), Kind::distractor, 3)) cases.push_back(std::move(j));
  ASSERT_EQ(cases.size(), 8u);
  int wrong = 0;
  for (const Judged& j : cases) wrong += !j.answer.named.empty();
  EXPECT_LT(wrong, 3);
}

// 5 % of wrong names are allowed: 3 or more of 5 come with a chance of 1.2e-3 at most.
TEST_P(SealedTables, WhatNoLibraryHasIsNotNamed) {
  int wrong = 0, count = 0;
  for (const Judged& j : answers(GetParam(), Kind::outside, 5)) {
    if (j.truth.apart != Apart::yes) continue;
    ++count;
    wrong += !j.answer.named.empty();
  }
  EXPECT_GE(count, 1);
  EXPECT_LT(wrong, 3);
}
INSTANTIATE_TEST_SUITE_P(Domains, SealedTables, testing::Values("sensor", "expression", "light", "volume"),
                         [](const auto& info) { return std::string(info.param); });

// 95 % are to be found: 4 or more missed of 8 come with a chance of 4e-4; 90 % are to be in the answer: 5 or more of 8
// that are not, with one of 4e-4.
TEST(SealedSlice, EffectsOfASensorAreFoundAndInTheAnswer) {
  EXPECT_LT(stats::binomial_upper(4, 8, 0.05), 1e-3);
  EXPECT_LT(stats::binomial_upper(5, 8, 0.1), 1e-3);
  int clear = 0, missed = 0, unsaid = 0;
  for (const Judged& j : answers("sensor", Kind::single, 14)) {
    if (times_the_limit(j) < 3 || j.truth.share < 0.013 || clear == 8) continue;
    ++clear;
    missed += j.answer.verdict == "null";
    const auto& reported = j.answer.reported;
    unsaid += std::find(reported.begin(), reported.end(), j.truth.mechanisms[0]) == reported.end();
  }
  EXPECT_GE(clear, 5);
  EXPECT_LT(missed, 4);
  EXPECT_LT(unsaid, 5);
}

}  // namespace
}  // namespace gonio::sealed
