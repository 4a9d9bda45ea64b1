// robot.friction-heating: one of the heatings of robot_warm_up.h.
#include "robot/mechanisms/robot_warm_up.h"

namespace gonio::mechanism {

const Mechanism& robot_friction_heating() {
  static const Mechanism declaration{
      .id = "robot.friction-heating",
      .sentence = "A joint's friction heats it by how fast it turns.",
      .typical = "2 to 50 K per rad/s",
      .equation =
          "dT/dt = rate_per_s (rest_K + rise_K_s_per_rad |speed| - T), from the level at the beginning of "
          "every session; speed the mean modulus of a row",
      .source =
          "first-order thermal response; Incropera & DeWitt, Fundamentals of Heat and Mass Transfer, section 5.1; "
          "Armstrong-Helouvry et al., Automatica 30, 1994 (friction)",
      .stage = "pose",
      .target = Target::scene,
      .domains = {"tables"},
      .parameters = {{.name = "rate_per_s",
                      .unit = "1/s",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.1,
                      .start = 7e-4,
                      .meaning = "the reciprocal of the time constant; 0: the joint stays at its level"},
                     {.name = "rest_K",
                      .unit = "K",
                      .neutral = 300,
                      .lower = 200,
                      .upper = 500,
                      .start = 300,
                      .meaning = "where it would end at rest; without effect at rate 0"},
                     {.name = "rise_K_s_per_rad",
                      .unit = "K s/rad",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1000,
                      .start = 5,
                      .meaning = "of the temperature that a steady speed holds; without effect at rate 0"}},
      .conditions = {"robot.speed", "robot.time"},
      .mistaken_for = {{.with = "robot.warm-up",
                        .told_apart = "let the arm rest for a time constant, powered, and work again"},
                       {.with = "robot.joule-heating", .told_apart = "the same motion with another payload"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
