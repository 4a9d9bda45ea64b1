// Hand-eye recordings as a problem: the forward model against an arm built otherwise, derivatives, the estimated noise,
// refusals.
#include <gmock/gmock.h>

#include <cmath>

#include "base/error.h"
#include "explain/robot/robot_findings.h"
#include "explain/robot/robot_world.h"
#include "manifest/document.h"
#include "manifest/sections/image.h"
#include "manifest/sections/mounting.h"
#include "manifest/sections/table.h"
#include "robot/ur_calibration.h"

namespace gonio::explain::tests {
namespace {

CellTruth still() {
  CellTruth truth;
  truth.robot_shift_m = truth.robot_turn_rad = 0;
  truth.corner_px = 1e-5;
  return truth;
}
RobotWork settled(const CellTruth& truth, std::size_t views, std::uint64_t seed, bool joints = true) {
  RobotWork work;
  work.input = robot_inputs(robot_cell(truth, views, seed)).at(0);
  if (!joints) work.input.links.clear();
  work.parameters = robot_parameters(work.input);
  settle(work);
  return work;
}
double estimated(const RobotWork& work, const std::string& parameter) {
  for (std::size_t p = 0; p < work.parameters.parameters.size(); ++p)
    if (work.parameters.parameters[p].name == parameter) return work.noise.estimate[static_cast<Eigen::Index>(p)];
  throw std::runtime_error("no parameter " + parameter);
}

TEST(ExplainRobot, TheChainIsThatOfAnArmBuiltOtherwise) {
  const RobotWork work = settled(still(), 20, 1);
  const ChainState state = state_of(work.input, work.parameters, work.aligned);
  for (std::size_t v = 0; v < 20; ++v) {
    const auto& view = work.input.views[v];
    EXPECT_LT(pose_difference(work, v, state).norm(), 1e-6) << view.image;
    const auto own = robot::flange(work.input.links, view.joints_rad);
    EXPECT_LT(norm(own.translation_m - view.base_from_tool.translation_m), 1e-9);
  }
  EXPECT_LT(work.noise.sizes.robot_m, 1e-6);
  EXPECT_LT(work.noise.sizes.robot_rad, 1e-6);
}

// Without noise every hypothesis finds its own truth, all others being free beside it, but for what one Gauss-Newton
// step leaves.
TEST(ExplainRobot, EveryHypothesisMeansWhatTheOtherArmDoes) {
  CellTruth offsets = still();
  offsets.joint_offset_rad = {0, 8e-4, -6e-4, 5e-4, -9e-4, 0};
  const RobotWork turned = settled(offsets, 40, 2);
  for (int j = 2; j <= 5; ++j)
    EXPECT_NEAR(estimated(turned, "robot.joint-offset.joint_" + std::to_string(j) + "_rad"),
                offsets.joint_offset_rad[static_cast<std::size_t>(j - 1)], 6e-5)
        << j;
  CellTruth sag = still();
  sag.sag_rad_per_m = 1e-3;
  const RobotWork hanging = settled(sag, 40, 3);
  EXPECT_NEAR(estimated(hanging, "robot.sag.joint_2_rad_per_m"), 1e-3, 6e-5);
  EXPECT_NEAR(estimated(hanging, "robot.sag.joint_3_rad_per_m"), 1e-3, 6e-5);
  CellTruth longer = still();
  longer.longer_upper_arm_m = 1e-3;
  EXPECT_NEAR(estimated(settled(longer, 40, 4), "robot.link-length.a_2_m"), -1e-3, 6e-5);  // UR: along -x
  CellTruth board = still();
  board.board_stretch = 2e-3;
  board.board_sag_m = 3e-4;
  const RobotWork bent = settled(board, 40, 5, false);  // all lengths of the arm larger by as much look the same
  EXPECT_NEAR(estimated(bent, "board.scale.scale_x"), 2e-3, 1e-4);
  EXPECT_NEAR(estimated(bent, "board.warp.sag_x_m"), 3e-4, 2e-5);
}

TEST(ExplainRobot, DerivativesAreThoseOfDifferences) {
  CellTruth truth;
  const auto problem = robot_problem(robot_inputs(robot_cell(truth, 12, 6)).at(0));
  const std::vector<Parameter>& parameters = problem->parameters();
  std::vector<double> values;
  for (const Parameter& p : parameters) values.push_back(p.neutral + 1e-6 * p.size);
  std::vector<std::size_t> columns;
  for (std::size_t p = 0; p < parameters.size(); ++p) columns.push_back(p);
  std::vector<double> exact(6 * columns.size()), up(6), down(6);
  problem->jacobian(values, 3, columns, exact);
  for (const std::size_t p : columns) {
    std::vector<double> moved = values;
    const double step = 1e-3 * parameters[p].size;
    moved[p] += step;
    problem->predict(moved, 3, up);
    moved[p] -= 2 * step;
    problem->predict(moved, 3, down);
    double length = 0, off = 0;
    for (std::size_t i = 0; i < 6; ++i) {
      const double slope = (up[i] - down[i]) / (2 * step);
      length += slope * slope;
      off += (slope - exact[6 * p + i]) * (slope - exact[6 * p + i]);
    }
    EXPECT_LT(std::sqrt(off),
              0.03 * std::sqrt(length) + 1e-6)  // Gauss-Newton: corner noise times curvature is left out
        << parameters[p].name;
  }
}

TEST(ExplainRobot, NoiseOfTheToolMovesTheBoardAsTheChainSays) {
  ChainInput input = robot_inputs(robot_cell({}, 8, 7)).at(0);
  ChainState state;
  for (const bool eye_to_hand : {false, true}) {
    input.eye_to_hand = eye_to_hand;
    for (const ChainInput::View& view : input.views) {
      const PoseMatrix by = matrix_of(by_tool(input, view, state));
      for (int k = 0; k < 6; ++k) {
        constexpr double step = 1e-6;
        ChainInput::View moved = view;
        std::array<double, 6> xi{};
        xi[static_cast<std::size_t>(k)] = step;
        moved.base_from_tool =
            view.base_from_tool * Rigid<frame::Tool, frame::Tool>{quaternion_of_rotation_vector({xi[0], xi[1], xi[2]}),
                                                                  {xi[3], xi[4], xi[5]}};
        const PoseChange change =
            vector_of(change_between(chain_pose(input, view, state), chain_pose(input, moved, state))) / step;
        EXPECT_LT((change - by.col(k)).norm(), 1e-5) << k;
      }
    }
  }
}

TEST(ExplainRobot, TheRobotsNoiseIsEstimatedWithoutBias) {
  CellTruth truth;
  truth.robot_shift_m = 3e-4;
  truth.robot_turn_rad = 4e-4;
  double shift = 0, turn = 0;
  constexpr int sets = 12;
  for (int seed = 0; seed < sets; ++seed) {
    const RobotNoise noise = settled(truth, 30, 100 + static_cast<std::uint64_t>(seed)).noise;
    shift += noise.sizes.robot_m * noise.sizes.robot_m / sets;
    turn += noise.sizes.robot_rad * noise.sizes.robot_rad / sets;
  }
  EXPECT_NEAR(std::sqrt(shift), truth.robot_shift_m, 0.06 * truth.robot_shift_m);  // three standard errors of the mean
  EXPECT_NEAR(std::sqrt(turn), truth.robot_turn_rad, 0.06 * truth.robot_turn_rad);
}

TEST(ExplainRobot, APoseBeyondAnyNoiseIsLeftOutAndNamed) {
  manifest::Document document = robot_cell({}, 20, 8);
  document.images[5].base_from_tool->translation_m.x += 0.01;
  RobotWork work;
  work.input = robot_inputs(document).at(0);
  work.parameters = robot_parameters(work.input);
  settle(work);
  EXPECT_THAT(work.outliers, testing::ElementsAre("view5"));
  EXPECT_EQ(work.input.views.size(), 19u);
  EXPECT_LT(work.noise.sizes.robot_m, 1.5e-4);
}

// What handeye left out is left out, but the arm went through it.
TEST(ExplainRobot, PosesThatHandeyeLeftOutAreLeftOut) {
  manifest::Document document = robot_cell({}, 12, 8);
  const ChainInput whole = robot_inputs(document).at(0);
  document.mountings["hand"].outliers = {"view5"};
  const ChainInput input = robot_inputs(document).at(0);
  ASSERT_EQ(input.views.size(), 11u);
  for (const ChainInput::View& view : input.views) EXPECT_NE(view.image, "view5");
  EXPECT_EQ(input.views[5].approach, whole.views[6].approach);
  // More than a quarter are no strays: they are what is to be explained.
  document.mountings["hand"].outliers = {"view0", "view1", "view2"};
  EXPECT_EQ(robot_inputs(document).at(0).views.size(), 9u);
  document.mountings["hand"].outliers.emplace_back("view3");
  EXPECT_EQ(robot_inputs(document).at(0).views.size(), 12u);
}

TEST(ExplainRobot, WhatTheRecordingsLackIsNoHypothesis) {
  const auto ids = [](const Problem& problem) {
    std::vector<std::string> result;
    for (const Candidate& c : problem.candidates()) result.push_back(c.id());
    return result;
  };
  manifest::Document document = robot_cell({}, 12, 9);
  EXPECT_THAT(
      ids(*robot_problem(robot_inputs(document).at(0))),
      testing::IsSupersetOf({"robot.joint-offset", "robot.link-length", "robot.sag", "board.warp", "board.scale"}));
  document.images[3].joints_rad.clear();
  EXPECT_THAT(ids(*robot_problem(robot_inputs(document).at(0))),
              testing::Each(testing::Not(testing::StartsWith("robot."))));
  document.tables.clear();
  EXPECT_THROW(robot_inputs(document), Error);  // neither corners nor a stated sigma
  document.images.resize(5);
  EXPECT_FALSE(has_hand_eye(document));
  document.mountings.clear();
  EXPECT_FALSE(has_hand_eye(document));
}

// The rotation of the first joint is one of the board's place, that of the last one of the camera's: never hypotheses.
TEST(ExplainRobot, WhatTheMountingImitatesIsNoHypothesis) {
  const auto problem = robot_problem(robot_inputs(robot_cell({}, 20, 10)).at(0));
  for (const Candidate& c : problem->candidates()) {
    if (c.id() != "robot.joint-offset") continue;
    std::vector<std::string> names;
    for (const std::size_t p : c.parameters) names.push_back(problem->parameters()[p].name);
    EXPECT_THAT(names, testing::ElementsAre("robot.joint-offset.joint_2_rad", "robot.joint-offset.joint_3_rad",
                                            "robot.joint-offset.joint_4_rad", "robot.joint-offset.joint_5_rad"));
  }
}

}  // namespace
}  // namespace gonio::explain::tests
