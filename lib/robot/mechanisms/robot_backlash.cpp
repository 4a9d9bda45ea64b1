// robot.backlash: joints that stand elsewhere when they are approached from the other side. Equation:
// robot/chain/chain.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& robot_backlash() {
  static const Mechanism declaration{
      .id = "robot.backlash",
      .sentence = "The robot's gears have play: a joint that came from below stands elsewhere than one from above.",
      .typical = "0.02 to 0.2 mm at the tool",
      .equation =
          "q_i -> q_i + backlash_i_rad s_i / 2, s_i = 1 where joint i last turned forwards, -1 where backwards, by the "
          "order of the images' time_s (else of the list)",
      .source = "Mooring, Roth & Driels 1991, chapter 2 (non-geometric errors)",
      .stage = "pose",
      .target = Target::scene,
      .domains = {"robot"},
      .parameters = {{.name = "backlash_1_rad",
                      .unit = "rad",
                      .lower = -0.01,
                      .upper = 0.01,
                      .typical = 2e-4,
                      .meaning = "play of joint 1"},
                     {.name = "backlash_2_rad",
                      .unit = "rad",
                      .lower = -0.01,
                      .upper = 0.01,
                      .typical = 2e-4,
                      .meaning = "play of joint 2"},
                     {.name = "backlash_3_rad",
                      .unit = "rad",
                      .lower = -0.01,
                      .upper = 0.01,
                      .typical = 2e-4,
                      .meaning = "play of joint 3"},
                     {.name = "backlash_4_rad",
                      .unit = "rad",
                      .lower = -0.01,
                      .upper = 0.01,
                      .typical = 2e-4,
                      .meaning = "play of joint 4"},
                     {.name = "backlash_5_rad",
                      .unit = "rad",
                      .lower = -0.01,
                      .upper = 0.01,
                      .typical = 2e-4,
                      .meaning = "play of joint 5"},
                     {.name = "backlash_6_rad",
                      .unit = "rad",
                      .lower = -0.01,
                      .upper = 0.01,
                      .typical = 2e-4,
                      .meaning = "play of joint 6"}},
      .conditions = {"robot.approach-2", "robot.approach-3", "robot.approach-4", "robot.approach-5"},
      .mistaken_for = {{.with = "noise", .told_apart = "approach the same poses from both directions"},
                       {.with = "robot.time-offset", .told_apart = "stop before each photograph"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
