// robot.thermal: an arm that grows while it warms up. Equation: explain/robot/robot_chain.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& robot_thermal() {
  static const Mechanism declaration{
      .id = "robot.thermal",
      .sentence = "The arm's links grow with its temperature, or with time while it warms up.",
      .typical = "10 to 25 ppm / K; a cold start drifts by up to ten times the repeatability",
      .equation =
          "a_i, d_i -> (1 + growth_per_K dT) a_i, d_i for all links, dT = T - mean(T) over the images' temperature_K: "
          "the "
          "flange's position is scaled; with growth_per_s the same over time_s",
      .source = "Heisel, Richter & Wurst, CIRP Annals 46(1), 1997 (thermal behaviour of industrial robots)",
      .stage = "pose",
      .target = Target::scene,
      .domains = {"robot", "tables"},
      .parameters = {{.name = "growth_per_K",
                      .unit = "1/K",
                      .lower = -2e-4,
                      .upper = 2e-4,
                      .typical = 1.5e-5,
                      .meaning = "growth of all links"},
                     {.name = "growth_per_s",
                      .unit = "1/s",
                      .lower = -1e-5,
                      .upper = 1e-5,
                      .typical = 1.5e-7,
                      .meaning = "growth of all links"}},
      .conditions = {"robot.temperature", "robot.time", "robot.reach"},
      .mistaken_for = {{.with = "focal length", .told_apart = "warm the robot up and repeat the poses"},
                       {.with = "camera.thermal", .told_apart = "photograph a fixed target, the robot at rest"},
                       {.with = "robot.link-length", .told_apart = "warm the robot up and repeat the poses"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
