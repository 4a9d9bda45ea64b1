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
      .source = std::string(first_order_source) + "; Armstrong-Helouvry et al., Automatica 30, 1994 (friction)",
      .stage = "pose",
      .target = Target::scene,
      .domains = {"tables"},
      .parameters = {heating_rate(), heating_level("rest_K", 300, "where it would end at rest"),
                     heating_rise("rise_K_s_per_rad", "K s/rad", 5, "of the temperature that a steady speed holds")},
      .conditions = {"robot.speed", "robot.time"},
      .mistaken_for = {{.with = "robot.warm-up",
                        .told_apart = "let the arm rest for a time constant, powered, and work again"},
                       {.with = "robot.joule-heating", .told_apart = "the same motion with another payload"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
