// Inverse kinematics held against forward kinematics: known arms, arms of real controllers' calibrations, arms of
// random geometry. GONIO_INVERSE_POSES=1000000 makes the long run.
#include "robot/inverse/inverse_kinematics.h"

#include <gmock/gmock.h>

#include "base/error.h"
#include "data.h"
#include "inverse_world.h"
#include "robot/ur_calibration.h"

namespace gonio::robot {
namespace {

using namespace inverse_world;

TEST(InverseKinematics, AllAnswersOfKnownArmsReachThePose) {
  for (const Arm& arm : known_arms()) {
    const InverseKinematics inverse(arm.links);
    EXPECT_EQ(inverse.family(), arm.name[0] == 'u' ? Family::three_parallel : Family::spherical_wrist);
    ASSERT_TRUE(inverse.has_branches());
    Tally tally;
    Random random(41, 1);
    for (int i = 0; i < poses_of_a_run(2000); ++i) tally.take(inverse, arm.links, random_joints(random));
    std::printf("%s: %s\n", arm.name.c_str(), tally.words().c_str());
    EXPECT_EQ(tally.lost, 0) << arm.name;
    EXPECT_EQ(tally.repeated, 0) << arm.name;
    EXPECT_EQ(tally.wrong_branch, 0) << arm.name;
    EXPECT_LT(tally.worst_m, 1e-12) << arm.name;
    EXPECT_LT(tally.worst_rad, 1e-12) << arm.name;
  }
}

TEST(InverseKinematics, CalibratedArms) {
  GONIO_NEEDS_DATA("universal-robots/calibration_conf");
  for (const char* robot : {"robot_117", "robot_118", "robot_124", "robot_125"}) {
    const auto file = tests::data("universal-robots/calibration_conf") / robot / "calibration.conf";
    const Arm arm = calibrated(known_arm("ur10e", "test"), read_ur_calibration(file), "test");
    const InverseKinematics inverse(arm.links);
    EXPECT_EQ(inverse.family(), Family::three_parallel);
    Tally tally;
    Random random(43, 1);
    for (int i = 0; i < poses_of_a_run(500); ++i) tally.take(inverse, arm.links, random_joints(random));
    std::printf("%s: %s\n", robot, tally.words().c_str());
    // Beside a singular posture, where two answers are about to vanish into one, one in some ten thousand is missed.
    EXPECT_LE(tally.lost, tally.poses / 5000) << robot;
    EXPECT_LT(tally.worst_m, InverseKinematics::exact_limit) << robot;
    EXPECT_LT(tally.worst_rad, InverseKinematics::exact_limit) << robot;
  }
}

}  // namespace
}  // namespace gonio::robot
