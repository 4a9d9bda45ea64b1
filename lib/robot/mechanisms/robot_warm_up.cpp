// robot.warm-up: one of the heatings of robot_warm_up.h.
#include "robot/mechanisms/robot_warm_up.h"

namespace gonio::mechanism {

const Mechanism& robot_warm_up() {
  static const Mechanism declaration{
      .id = "robot.warm-up",
      .sentence = "A joint of the arm warms up, under a heating that stays the same.",
      .typical = "3 to 20 K in 10 to 60 minutes",
      .equation = "dT/dt = rate_per_s (target_K - T), from the level at the beginning of every session",
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
                     {.name = "target_K",
                      .unit = "K",
                      .neutral = 300,
                      .lower = 200,
                      .upper = 500,
                      .start = 310,
                      .meaning = "where it ends; without effect at rate 0"}},
      .conditions = {"robot.time"},
      .mistaken_for = {{.with = "robot.joule-heating",
                        .told_apart = "let the arm rest for a time constant, powered, and work again"},
                       {.with = "robot.friction-heating",
                        .told_apart = "let the arm rest for a time constant, powered, and work again"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
