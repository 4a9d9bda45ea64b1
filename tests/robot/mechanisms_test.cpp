// Mechanisms of robots and boards as explain's hand-eye domain uses them: declared whole, neutral at zero,
// bit-identical there.
#include <gmock/gmock.h>

#include "mechanism/mechanism.h"
#include "robot/chain/chain.h"
#include "robot/kinematics.h"

namespace gonio::robot {
namespace {

TEST(RobotMechanisms, AreDeclaredWhole) {
  for (const char* id : {"robot.joint-offset", "robot.link-length", "robot.sag", "board.scale"}) {
    const mechanism::Mechanism* m = mechanism::find_mechanism(id);
    ASSERT_NE(m, nullptr) << id;
    EXPECT_THAT(m->domains, testing::Contains("robot"));
    EXPECT_FALSE(m->conditions.empty());
    EXPECT_FALSE(m->mistaken_for.empty());
    for (const mechanism::Parameter& p : m->parameters) {
      EXPECT_EQ(p.neutral, 0) << p.name;
      EXPECT_LT(p.lower, 0) << p.name;
      EXPECT_GT(p.upper, 0) << p.name;
      EXPECT_TRUE(p.unit == "1" || p.name.ends_with("_m") || p.name.ends_with("_rad")) << p.name;
    }
  }
}

TEST(RobotMechanisms, AtTheirNeutralValuesTheToolStaysWhereItWas) {
  ChainInput input;
  input.links = known_arm("ur10e", "test").links;
  ChainInput::View view;
  view.joints_rad = {0.1, -1.2, 1.3, -0.4, 0.5, 0.6};
  view.base_from_tool = flange(input.links, view.joints_rad);
  EXPECT_EQ(tool_pose(input, view, {}), view.base_from_tool);
  ChainState moved;
  moved.joint_rad[1] = 1e-12;
  EXPECT_LT(norm(tool_pose(input, view, moved).translation_m - view.base_from_tool.translation_m), 2e-12);
}

TEST(RobotMechanisms, SagLowersTheTool) {
  ChainInput input;
  input.links = known_arm("abb-irb-1600", "test").links;
  ChainInput::View view;
  view.joints_rad = {0, pi / 2, -pi / 2, 0, 0, 0};  // stretched forward: levers of 1.365 and 0.665 m
  view.base_from_tool = flange(input.links, view.joints_rad);
  ChainState state;
  state.sag_rad_per_m = {1e-4, 2e-4};
  const double drop = view.base_from_tool.translation_m.z - tool_pose(input, view, state).translation_m.z;
  EXPECT_NEAR(drop, 1e-4 * 1.365 * 1.365 + 2e-4 * 0.665 * 0.665, 1e-7);
}

}  // namespace
}  // namespace gonio::robot
