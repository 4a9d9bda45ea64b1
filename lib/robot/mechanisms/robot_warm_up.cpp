// robot.warm-up: one of the heatings of robot_warm_up.h.
#include "robot/mechanisms/robot_warm_up.h"

namespace gonio::mechanism {

const Mechanism& robot_warm_up() {
  static const Mechanism declaration{
      .id = "robot.warm-up",
      .sentence = "A joint of the arm warms up, under a heating that stays the same.",
      .typical = "3 to 20 K in 10 to 60 minutes",
      .equation = "dT/dt = rate_per_s (target_K - T), from the level at the beginning of every session",
      .source = first_order_source,
      .stage = "pose",
      .target = Target::scene,
      .domains = {"tables"},
      .parameters = {heating_rate(), heating_level("target_K", 310, "where it ends")},
      .conditions = {"robot.time"},
      .mistaken_for = {{.with = "robot.joule-heating",
                        .told_apart = "let the arm rest for a time constant, powered, and work again"},
                       {.with = "robot.friction-heating",
                        .told_apart = "let the arm rest for a time constant, powered, and work again"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
