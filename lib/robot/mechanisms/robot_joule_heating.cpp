// robot.joule-heating: one of the heatings of robot_warm_up.h.
#include "robot/mechanisms/robot_warm_up.h"

namespace gonio::mechanism {

const Mechanism& robot_joule_heating() {
  static const Mechanism declaration{
      .id = "robot.joule-heating",
      .sentence = "A joint's motor heats it by the square of its current.",
      .typical = "0.5 to 10 K per A^2",
      .equation =
          "dT/dt = rate_per_s (rest_K + rise_K_per_A2 current_A^2 - T), from the level at the beginning of every "
          "session; current_A the root mean square of a row",
      .source = "first-order thermal response; Incropera & DeWitt, Fundamentals of Heat and Mass Transfer, section 5.1",
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
                      .meaning = "where it would end without current; without effect at rate 0"},
                     {.name = "rise_K_per_A2",
                      .unit = "K/A^2",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1000,
                      .start = 1,
                      .meaning = "of the temperature that a steady current holds; without effect at rate 0"}},
      .conditions = {"robot.current", "robot.time"},
      .mistaken_for = {{.with = "robot.warm-up",
                        .told_apart = "let the arm rest for a time constant, powered, and work again"},
                       {.with = "robot.friction-heating", .told_apart = "the same motion with another payload"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
