// What a robot does beside its kinematics, put into cells that share no code with the library (explain/robot_world.h):
// play, growth and lag are named, their intervals cover, and they are not named where they are absent.
#include <gmock/gmock.h>

#include <cmath>

#include "explain/engine.h"
#include "explain/robot/robot_problem.h"
#include "explain/robot/robot_world.h"
#include "manifest/document.h"
#include "robot/chain/chain.h"

namespace gonio::explain::tests {
namespace {

struct Answer {
  std::unique_ptr<RobotProblem> problem;
  Explanation e;
  std::vector<std::string> named;
};
Answer explained(const CellTruth& truth, std::size_t views, std::uint64_t seed) {
  Answer a;
  a.problem = robot_problem(robot_inputs(robot_cell(truth, views, seed)).at(0));
  a.e = explain(*a.problem, {});
  for (const std::size_t c : a.e.named) a.named.push_back(a.problem->candidates()[c].id());
  return a;
}
void expect_covers(const Answer& a, const std::string& parameter, double truth) {
  for (const Estimate& estimate : a.e.estimates)
    if (a.problem->parameters()[estimate.parameter].name == parameter) {
      EXPECT_NEAR(estimate.value, truth, 3.5 * estimate.sigma) << parameter;
      return;
    }
  ADD_FAILURE() << "nothing estimated for " << parameter << ": " << a.e.sentence;
}

TEST(RobotPassage, NeutralValuesLeaveThePoseToTheBit) {
  CellTruth truth;
  truth.in_motion = true;
  truth.warming_K = 5;
  const ChainInput input = robot_inputs(robot_cell(truth, 12, 1)).at(0);
  for (const ChainInput::View& view : input.views) EXPECT_EQ(tool_pose(input, view, {}), view.base_from_tool);
}

// A lag of the time to the next image brings the pose to that image's: the parabola goes through both neighbours.
TEST(RobotPassage, TheParabolaGoesThroughTheNeighbours) {
  CellTruth truth;
  truth.in_motion = true;
  const ChainInput input = robot_inputs(robot_cell(truth, 12, 1)).at(0);
  int passed = 0;
  for (std::size_t v = 1; v + 1 < input.views.size(); ++v) {
    if (!input.views[v].passes) continue;
    ++passed;
    for (const std::size_t to : {v - 1, v + 1}) {
      ChainState state;
      state.lag_s = *input.views[to].time_s - *input.views[v].time_s;
      const auto at = tool_pose(input, input.views[v], state), there = input.views[to].base_from_tool;
      EXPECT_LT(norm(at.translation_m - there.translation_m), 1e-9);
      EXPECT_LT(norm(rotation_vector_of(conjugate(at.rotation) * there.rotation)), 1e-9);
    }
  }
  EXPECT_GE(passed, 6);
  EXPECT_FALSE(input.views.front().passes);
  EXPECT_FALSE(input.views.back().passes);
}

TEST(RobotPassage, TheSignOfApproachIsThatOfTheLastTurn) {
  const ChainInput input = robot_inputs(robot_cell({}, 10, 2)).at(0);
  EXPECT_EQ(input.views[0].approach, (std::array<double, 6>{}));
  for (std::size_t v = 1; v < input.views.size(); ++v)
    for (std::size_t j = 0; j < 6; ++j)
      EXPECT_EQ(input.views[v].approach[j] > 0, input.views[v].joints_rad[j] > input.views[v - 1].joints_rad[j]);
}

TEST(RobotMechanismsFound, PlayOfTheGears) {
  CellTruth truth;
  truth.backlash_rad = {0, 8e-4, 7e-4, 0, 0, 0};
  const Answer a = explained(truth, 40, 3);
  EXPECT_THAT(a.named, testing::ElementsAre("robot.backlash")) << a.e.sentence;
  expect_covers(a, "robot.backlash.backlash_2_rad", 8e-4);
  expect_covers(a, "robot.backlash.backlash_3_rad", 7e-4);
  EXPECT_THAT(a.e.conditions[0].name, testing::StartsWith("robot.approach-"));
  EXPECT_LT(a.e.held_out_after, a.e.held_out_before);
}

TEST(RobotMechanismsFound, AnArmThatGrowsWithItsTemperature) {
  CellTruth truth;
  truth.growth_per_K = 2.5e-5;
  truth.warming_K = 20;
  const Answer a = explained(truth, 40, 4);
  EXPECT_THAT(a.named, testing::ElementsAre("robot.thermal")) << a.e.sentence;
  expect_covers(a, "robot.thermal.growth_per_K", 2.5e-5);
  EXPECT_EQ(a.e.conditions[0].name, "robot.temperature");
}

TEST(RobotMechanismsFound, PosesThatLagBehindThePhotographs) {
  CellTruth truth;
  truth.in_motion = true;
  truth.lag_s = 4e-3;
  const Answer a = explained(truth, 40, 5);
  EXPECT_THAT(a.named, testing::ElementsAre("robot.time-offset")) << a.e.sentence;
  expect_covers(a, "robot.time-offset.lag_s", 4e-3);
  EXPECT_EQ(a.e.conditions[0].name, "robot.speed");
}

TEST(RobotMechanismsFound, NothingWhereNothingIsWrong) {
  int named = 0;
  for (std::uint64_t seed = 0; seed < 8; ++seed) {
    CellTruth truth;
    truth.in_motion = seed % 2 == 0;
    truth.warming_K = seed % 4 < 2 ? 10 : 0;
    named += !explained(truth, 20, 300 + seed).named.empty();
  }
  EXPECT_LE(named, 1);  // 1 % each: more than one in eight has a chance of 0.3 %
}

}  // namespace
}  // namespace gonio::explain::tests
