// What a domain leaves to another: poses fitted to corners cannot name of a lens what the corners themselves refused.
#include <gmock/gmock.h>

#include "explain/domains.h"
#include "inference/toy_problem.h"
#include "mechanism/mechanism.h"

namespace gonio::explain::tests {
namespace {

class WithCandidates : public ToyFrame {
 public:
  WithCandidates(std::string domain, const std::vector<std::string>& ids) : domain_(std::move(domain)) {
    for (const std::string& id : ids) candidates_.push_back({mechanism::find_mechanism(id), {}, {}, "", false});
  }
  std::string domain() const override { return domain_; }
  void predict(std::span<const double>, std::size_t, std::span<double>) const override {}

 private:
  std::string domain_;
};

const Domain& domain_named(const std::string& name) {
  return **std::ranges::find(all_domains(), name, &Domain::name);
}

TEST(LeftToBoards, WhatTheyLookedAtAndDidNotNameOfALensIsRefused) {
  const WithCandidates boards("boards", {"lens.radial", "lens.tangential", "lens.thin-prism", "board.scale"});
  Explanation e;
  e.named = {0};
  e.not_told_apart = {{0, 2}};
  const Answered answer{&boards, &e};
  EXPECT_THAT(refused_before(domain_named("robot"), {&answer, 1}),
              testing::ElementsAre("lens.tangential", "lens.thin-prism"));
  EXPECT_THAT(refused_before(domain_named("images"), {&answer, 1}), testing::IsEmpty());
  EXPECT_THAT(refused_before(domain_named("robot"), {}), testing::IsEmpty());
}

// What is refused is not named, and what was beside it still is.
TEST(LeftToBoards, WhatIsRefusedIsNotNamed) {
  ToyProblem::Truth truth;
  truth.amplitudes = {0.6, 0, 0.2};
  const ToyProblem problem(three_effects(), truth, 1);
  const Explanation e = explain(problem, {});
  ASSERT_FALSE(e.named.empty()) << e.sentence;
  const std::string least = problem.candidates()[e.named.back()].id();
  const Explanation without = explain_without(problem, {}, {least});
  EXPECT_GE(e.named.size(), 2u);
  EXPECT_EQ(without.named.size(), e.named.size() - 1) << without.sentence;
  for (const std::size_t c : without.named) EXPECT_NE(problem.candidates()[c].id(), least) << without.sentence;
  EXPECT_TRUE(without.significant);
  EXPECT_EQ(explain_without(problem, {}, {}).sentence, e.sentence);
}

}  // namespace
}  // namespace gonio::explain::tests
