// explain on hand-eye recordings of a sealed cell: joint zeros found with honest intervals, nothing found where nothing
// is, and whose the scatter is.
#include <gmock/gmock.h>

#include <cmath>

#include "explain/domains.h"
#include "explain/engine.h"
#include "explain/robot/robot_problem.h"
#include "explain/robot/robot_world.h"
#include "geom/angle.h"
#include "manifest/document.h"
#include "manifest/sections/mounting.h"
#include "manifest/sections/robot.h"
#include "robot/handeye/consensus.h"
#include "robot/handeye_document.h"

namespace gonio::explain::tests {
namespace {

struct Answer {
  std::unique_ptr<RobotProblem> problem;
  Explanation e;
  std::vector<std::string> named, reported;  // reported: with what was not told apart
};
Answer explained(const CellTruth& truth, std::size_t views, std::uint64_t seed) {
  Answer a{robot_problem(robot_inputs(robot_cell(truth, views, seed)).at(0)), {}, {}, {}};
  a.e = explain(*a.problem, {});
  for (const std::size_t c : a.e.named) a.named.push_back(a.problem->candidates()[c].id());
  a.reported = a.named;
  for (const auto& set : a.e.not_told_apart)
    for (const std::size_t c : set) a.reported.push_back(a.problem->candidates()[c].id());
  return a;
}

// Mooring's question: 0.05 degrees in the zeros of four joints, 40 views, 0.1 px, a robot that repeats to 0.05 mm.
TEST(ExplainRobotEngine, JointZerosOfATwentiethDegreeAreFoundWithHonestIntervals) {
  int covered = 0, intervals = 0;
  for (std::uint64_t seed = 1; seed <= 2; ++seed) {
    CellTruth truth;
    const double off = 0.05 * degree;
    truth.joint_offset_rad = {0, off, -off, off, -off, 0};
    const Answer a = explained(truth, 40, seed);
    EXPECT_THAT(a.named, testing::ElementsAre("robot.joint-offset")) << a.e.sentence;
    EXPECT_LT(a.e.held_out_after, 0.6 * a.e.held_out_before);
    for (const Estimate& estimate : a.e.estimates) {
      const std::string& name = a.problem->parameters()[estimate.parameter].name;
      const double truly = truth.joint_offset_rad[static_cast<std::size_t>(name[name.find("joint_") + 6] - '1')];
      EXPECT_NEAR(estimate.value, truly, 3.5 * estimate.sigma) << name;
      covered += truly > estimate.lower_95 && truly < estimate.upper_95;
      ++intervals;
    }
  }
  EXPECT_EQ(intervals, 8);
  EXPECT_GE(covered, 7);
}

TEST(ExplainRobotEngine, WhereNothingIsWrongNothingIsNamed) {
  int named = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    CellTruth truth;
    truth.robot_shift_m = seed % 2 == 0 ? 5e-5 : 5e-4;
    truth.robot_turn_rad = seed % 2 == 0 ? 5e-5 : 1e-3;
    const Answer a = explained(truth, 14, 200 + seed);
    named += !a.named.empty();
  }
  EXPECT_LE(named, 1);
}

TEST(ExplainRobotEngine, SagIsFoundOrSaidToLookLikeJointZeros) {
  CellTruth truth;
  truth.sag_rad_per_m = 1e-3;
  const Answer a = explained(truth, 30, 5);
  EXPECT_THAT(a.reported, testing::Contains("robot.sag")) << a.e.sentence;
  EXPECT_THAT(a.e.sentence, testing::HasSubstr("The board's position scatters by"));
}

TEST(ExplainRobotEngine, AStretchedBoardIsNotTheRobots) {
  CellTruth truth;
  truth.board_stretch = 0.005;
  const Answer a = explained(truth, 24, 6);
  EXPECT_THAT(a.named, testing::ElementsAre("board.scale")) << a.e.sentence;
  for (const Estimate& estimate : a.e.estimates) EXPECT_NEAR(estimate.value, 0.005, 3.5 * estimate.sigma);
  const RobotFindings f = a.problem->findings(a.e);
  EXPECT_GT(*f.parts.board_m, 5e-5);
}

// The squares of the parts are those of the scatter, and each noise lands where it belongs.
TEST(ExplainRobotEngine, TheScatterIsSharedOutByItsSources) {
  CellTruth shaky, blurred;
  shaky.robot_shift_m = 5e-4;
  shaky.robot_turn_rad = 5e-4;
  blurred.robot_shift_m = blurred.robot_turn_rad = 1e-5;
  blurred.corner_px = 0.5;
  for (const bool robot : {true, false}) {
    const Answer a = explained(robot ? shaky : blurred, 20, 7);
    const RobotFindings f = a.problem->findings(a.e);
    const double larger = robot ? *f.parts.robot_m : *f.parts.camera_m,
                 smaller = robot ? *f.parts.camera_m : *f.parts.robot_m;
    EXPECT_GT(larger, 2 * smaller) << f.sentence;
    const double sum = std::hypot(std::hypot(*f.parts.robot_m, *f.parts.camera_m),
                                  std::hypot(*f.parts.board_m, *f.parts.unexplained_m));
    EXPECT_NEAR(sum, f.scatter_m, 0.15 * f.scatter_m) << f.sentence;
  }
}

// Near-frontal poses: the mounting imitates the wrist's zeros, and the answer says so and which sweeps would end it.
TEST(ExplainRobotEngine, WhatTheMountingNearlyImitatesIsSaidWithTheSweepThatSeparatesIt) {
  CellTruth truth;
  truth.tilt_rad = 0.1;
  const Answer a = explained(truth, 20, 7);
  const RobotFindings f = a.problem->findings(a.e);
  EXPECT_THAT(
      f.entangled,
      testing::Contains("the zero of joint 1 is the same as a change of the mounting: no poses tell them apart"));
  EXPECT_THAT(f.entangled, testing::Contains(testing::AllOf(testing::StartsWith("the zero of joint 5"),
                                                            testing::HasSubstr("correlation"))));
  EXPECT_THAT(f.next, testing::Contains(testing::StartsWith("sweep joint 5 alone")));
  manifest::Document document = robot_cell(truth, 20, 7);
  a.problem->apply(a.e, document);
  EXPECT_EQ(document.mountings["hand"].unobservable, f.entangled);
  EXPECT_EQ(document.mountings["hand"].next, f.next);
}

// The manifest that goes on: the named physics is in the arm's rows and the tool poses, and a second look finds nothing
// left.
TEST(ExplainRobotEngine, WhatIsNamedIsModelledInTheManifest) {
  CellTruth truth;
  truth.joint_offset_rad = {0, 2e-3, -2e-3, 2e-3, -2e-3, 0};
  manifest::Document document = robot_cell(truth, 24, 8);
  const auto problem = robot_problem(robot_inputs(document).at(0));
  const Explanation e = explain(*problem, {});
  ASSERT_EQ(e.verdict, Verdict::named) << e.sentence;
  problem->apply(e, document);
  EXPECT_NEAR(document.robots["arm"].dh.at(4).theta_rad, -2e-3, 2e-4);
  ASSERT_TRUE(document.mountings["hand"].parts.has_value());
  EXPECT_GT(document.mountings["hand"].tool_from_camera->sigma->translation_m.at(0), 0);
  const auto again = robot_problem(robot_inputs(document).at(0));
  EXPECT_TRUE(explain(*again, {}).named.empty());
}

robot::handeye::Noise noise_by_handeye(const manifest::Document& document) {
  const robot::HandEyeInput input = robot::handeye_input(document, {});
  return robot::handeye::find_consensus(input.setup, input.views).refined.noise;
}

// The same figure where nothing is named, whatever was asked meanwhile; and where the arm is put right, the figure is
// the one that handeye states of the manifest that goes on.
TEST(ExplainRobotEngine, TheNoiseIsTheOneThatHandeyeStates) {
  CellTruth truth;
  truth.robot_shift_m = 2e-4;
  truth.robot_turn_rad = 4e-4;
  for (const double off : {0.0, 4e-3}) {
    truth.joint_offset_rad = {0, off, -off, off, -off, 0};
    manifest::Document document = robot_cell(truth, 24, 12);
    const auto problem = robot_problem(robot_inputs(document).at(0));
    const Explanation e = explain(*problem, {});
    ASSERT_EQ(e.verdict == Verdict::named, off > 0) << e.sentence;
    EXPECT_THAT(e.sentence, testing::HasSubstr(off > 0 ? "once what is named is put in" : "as handeye states it"));
    if (off > 0) {
      EXPECT_GT(noise_by_handeye(document).robot_rad, 2 * truth.robot_turn_rad);
    }
    problem->apply(e, document);
    const manifest::Mounting& mounting = document.mountings["hand"];
    const robot::handeye::Noise noise = noise_by_handeye(document);
    EXPECT_NEAR(*mounting.robot_m, noise.robot_m, (off > 0 ? 0.15 : 0.03) * noise.robot_m);
    EXPECT_NEAR(*mounting.robot_rad, noise.robot_rad, (off > 0 ? 0.15 : 0.03) * noise.robot_rad);
    EXPECT_NEAR(noise.robot_m, truth.robot_shift_m, 0.3 * truth.robot_shift_m);
  }
}

// Views that acquire can be asked for, of which some would show a joint's zero that is off.
TEST(ExplainRobotEngine, PosesAreProposedThatTheArmReaches) {
  CellTruth truth;
  truth.joint_offset_rad = {0, 0, 1e-3, 0, 0, 0};
  const auto problem = robot_problem(robot_inputs(robot_cell(truth, 20, 3)).at(0));
  const std::vector<Proposal> proposals = problem->proposals();
  ASSERT_GT(proposals.size(), 3u);
  const Explanation e = explain(*problem, {});
  ASSERT_FALSE(e.named.empty()) << e.sentence;
  std::vector<double> without = e.values;
  for (const std::size_t p : problem->candidates()[e.named[0]].parameters)
    without[p] = problem->parameters()[p].neutral;
  double most = 0;
  for (std::size_t k = 0; k < proposals.size(); ++k) {
    const manifest::Value* images = proposals[k].setup.find("images");
    ASSERT_NE(images, nullptr);
    ASSERT_EQ(images->as_array().size(), 1u);
    EXPECT_NE(images->as_array()[0].find("camera_from_board"), nullptr);
    const ProposedRows with = problem->propose(e.values, k), lacking = problem->propose(without, k);
    ASSERT_EQ(with.prediction.size(), 6u);
    double squares = 0;
    for (std::size_t i = 0; i < 6; ++i)
      squares += std::pow((with.prediction[i] - lacking.prediction[i]) / with.sigma[i], 2);
    most = std::max(most, std::sqrt(squares));
  }
  EXPECT_GT(most, 1);
}

TEST(ExplainRobotEngine, ManifestsWithMountingsOfferTheDomain) {
  const auto problems = problems_of(robot_cell({}, 12, 9));
  ASSERT_EQ(problems.size(), 2u);
  EXPECT_EQ(problems[0]->domain(), "boards");
  EXPECT_EQ(problems[1]->domain(), "robot");
}

}  // namespace
}  // namespace gonio::explain::tests
