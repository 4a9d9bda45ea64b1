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
      .source = first_order_source,
      .stage = "pose",
      .target = Target::scene,
      .domains = {"tables"},
      .parameters = {heating_rate(), heating_level("rest_K", 300, "where it would end without current"),
                     heating_rise("rise_K_per_A2", "K/A^2", 1, "of the temperature that a steady current holds")},
      .conditions = {"robot.current", "robot.time"},
      .mistaken_for = {{.with = "robot.warm-up",
                        .told_apart = "let the arm rest for a time constant, powered, and work again"},
                       {.with = "robot.friction-heating", .told_apart = "the same motion with another payload"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
