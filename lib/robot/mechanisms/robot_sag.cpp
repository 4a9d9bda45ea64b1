// robot.sag: joints that yield under the weight they carry. Equation: robot/kinematics.h (weight_levers).
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& robot_sag() {
  static const Mechanism declaration{
      .id = "robot.sag",
      .sentence = "The robot's joints yield under gravity: the farther it reaches, the lower it hangs.",
      .typical = "0.05 to 0.5 mm",
      .equation =
          "q_i -> q_i + joint_i_rad_per_m l_i(q), l_i the lever arm, in m, of a weight at the flange about joint i; "
          "joint_i_rad_per_m is compliance times weight; gravity along base -z",
      .source = "Dumas, Caro, Garnier & Furet 2011 (joint compliance); Khalil & Dombre 2002, chapter 11",
      .stage = "pose",
      .target = Target::scene,
      .domains = {"robot", "tables"},
      .parameters = {{.name = "joint_2_rad_per_m",
                      .unit = "rad/m",
                      .lower = -0.01,
                      .upper = 0.01,
                      .typical = 4e-4,
                      .meaning =
                          "yielding of joint 2 per metre of lever arm (negative: a balancer that pushes too hard)"},
                     {.name = "joint_3_rad_per_m",
                      .unit = "rad/m",
                      .lower = -0.01,
                      .upper = 0.01,
                      .typical = 4e-4,
                      .meaning =
                          "yielding of joint 3 per metre of lever arm (negative: a balancer that pushes too hard)"}},
      .conditions = {"robot.reach"},
      .mistaken_for = {{.with = "robot.joint-offset", .told_apart = "change the payload"},
                       {.with = "robot.link-length", .told_apart = "change the payload"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
