// What to measure next on boards: views that all face the camera from one range cannot tell a bent board from the lens.
#include <gtest/gtest.h>

#include <cmath>

#include "explain/boards/board_world.h"
#include "explain/boards/boards_problem.h"
#include "explain/engine.h"
#include "inference/plan.h"
#include "inference/sentence.h"
#include "manifest/document.h"

namespace gonio::explain::tests {
namespace {

std::unique_ptr<Problem> frontal_views(std::uint64_t seed) {
  prove::CaseTruth truth;
  truth.lens.k1 = -0.08;
  prove::CaseDesign design;
  design.frontal = true, design.misplaced = 0;
  const auto document =
      manifest::parse_document(prove::board_case("sealed", truth, 6, seed, design).manifest, "sealed", ".");
  return boards_problem(boards_input(document));
}

TEST(BoardsPlan, ProposalsAreViewsInTheManifestsWords) {
  const std::unique_ptr<Problem> problem = frontal_views(1);
  const std::vector<Proposal> proposals = problem->proposals();
  ASSERT_GE(proposals.size(), 6u);
  std::vector<double> values;
  for (const Parameter& p : problem->parameters()) values.push_back(p.neutral);
  for (const std::size_t p : problem->base()) values[p] = problem->parameters()[p].start;
  for (std::size_t k = 0; k < proposals.size(); ++k) {
    const manifest::Value* images = proposals[k].setup.find("images");
    ASSERT_NE(images, nullptr);
    EXPECT_NE(images->as_array().at(0).find("camera_from_board"), nullptr);
    const ProposedRows rows = problem->propose(values, k);
    ASSERT_EQ(rows.nuisance.size(), 6u);
    ASSERT_EQ(rows.sigma.size(), rows.prediction.size());
    EXPECT_GE(rows.prediction.size(), 12u) << proposals[k].sentence;
    for (std::size_t i = 0; i < rows.prediction.size(); ++i) {
      EXPECT_TRUE(std::isfinite(rows.prediction[i])) << proposals[k].sentence;
      EXPECT_EQ(rows.nuisance[0].size(), rows.prediction.size());
    }
  }
}

// Whatever the race made of it: given that the bent board and the lens are open, the plan parts them.
TEST(BoardsPlan, WhatSeparatesIsPlanned) {
  const std::unique_ptr<Problem> problem = frontal_views(2);
  Explanation e = explain(*problem, {});
  ASSERT_EQ(e.named.size(), 1u) << e.sentence;
  const auto place_of = [&](const std::string& id) {
    std::size_t c = 0;
    while (problem->candidates().at(c).id() != id) ++c;
    return c;
  };
  const bool bent = problem->candidates()[e.named[0]].id() == "board.warp";
  const std::size_t other = place_of(bent ? "lens.radial" : "board.warp");
  e.not_told_apart = {{e.named[0], other}};
  e.plan.clear();
  make_plan(System(*problem, 1), e);
  ASSERT_FALSE(e.plan.empty()) << e.sentence;
  EXPECT_GT(e.plan[0].z, 10) << e.plan[0].sentence;
  EXPECT_EQ(e.plan[0].separates, (std::vector<std::size_t>{e.named[0], other}));
  for (std::size_t k = 1; k < e.plan.size(); ++k)
    if (e.plan[k].separates.size() > 1) {
      EXPECT_LE(e.plan[k].z, e.plan[k - 1].z);
    }
  write_sentence(*problem, e);
  EXPECT_NE(e.next_measurement.find(e.plan[0].sentence), std::string::npos) << e.next_measurement;
}

}  // namespace
}  // namespace gonio::explain::tests
