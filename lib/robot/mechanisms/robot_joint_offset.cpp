// robot.joint-offset: joints whose zero is not where the controller believes it. Equation: robot/kinematics.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& robot_joint_offset() {
  static const Mechanism declaration{
      .id = "robot.joint-offset",
      .sentence = "The zeros of the robot's joints are off: every pose is turned a little about each joint's axis.",
      .typical = "0.2 to 2 mm at the tool",
      .equation = "q_i -> q_i + joint_i_rad in T = product of Rz(q_i + theta_i) Tz(d_i) Tx(a_i) Rx(alpha_i)",
      .source = "Mooring, Roth & Driels 1991; Hollerbach & Wampler 1996",
      .stage = "pose",
      .target = Target::scene,
      .domains = {"robot", "tables"},
      .parameters = {{.name = "joint_1_rad",
                      .unit = "rad",
                      .lower = -0.03,
                      .upper = 0.03,
                      .typical = 1e-3,
                      .meaning = "error of joint 1's zero"},
                     {.name = "joint_2_rad",
                      .unit = "rad",
                      .lower = -0.03,
                      .upper = 0.03,
                      .typical = 1e-3,
                      .meaning = "error of joint 2's zero"},
                     {.name = "joint_3_rad",
                      .unit = "rad",
                      .lower = -0.03,
                      .upper = 0.03,
                      .typical = 1e-3,
                      .meaning = "error of joint 3's zero"},
                     {.name = "joint_4_rad",
                      .unit = "rad",
                      .lower = -0.03,
                      .upper = 0.03,
                      .typical = 1e-3,
                      .meaning = "error of joint 4's zero"},
                     {.name = "joint_5_rad",
                      .unit = "rad",
                      .lower = -0.03,
                      .upper = 0.03,
                      .typical = 1e-3,
                      .meaning = "error of joint 5's zero"},
                     {.name = "joint_6_rad",
                      .unit = "rad",
                      .lower = -0.03,
                      .upper = 0.03,
                      .typical = 1e-3,
                      .meaning = "error of joint 6's zero"}},
      .conditions = {"robot.joint-2", "robot.joint-3", "robot.reach"},
      .mistaken_for = {{.with = "mounting", .told_apart = "sweep single joints through their range, the board in view"},
                       {.with = "robot.sag", .told_apart = "change the payload"},
                       {.with = "robot.link-length", .told_apart = "reach far and near with the same wrist"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
