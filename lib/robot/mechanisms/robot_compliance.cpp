// robot.compliance: what carries the arm tilts and bends under its weight.
#include "robot/mechanisms/robot_compliance.h"

namespace gonio::mechanism {
namespace {

Parameter yielding(const char* name, const char* unit, double start, const char* meaning) {
  return {
      .name = name, .unit = unit, .lower = -0.05, .upper = 0.05, .start = start, .typical = start, .meaning = meaning};
}

}  // namespace

const Mechanism& robot_compliance() {
  static const Mechanism declaration{
      .id = "robot.compliance",
      .sentence =
          "What carries the arm yields under its weight: the farther out it reaches, the more floor and column "
          "lean that way.",
      .typical = "1 to 3 mrad for every metre that the arm reaches out; 5 to 20 mm at the tool of a mobile robot",
      .equation =
          "x' = x + f x (x - foot) + c x (x - foot - h z) + c x h z / 2, f = (-floor_x r_y, floor_y r_x, 0), c = h "
          "(-column_x r_y, column_y r_x, 0): r the load's horizontal offset from the column, h the column's height",
      .source =
          "Gere & Goodno, Mechanics of Materials, table H-1, case 6 (cantilever under an end moment); Klimchik, "
          "Pashkevich & Chablat, Mechanism and Machine Theory 2014 (compliance errors of robots)",
      .stage = "pose",
      .target = Target::scene,
      .domains = {"tables"},
      .parameters = {yielding("floor_x_rad_per_m", "rad/m", 1e-3, "tilt of the foot about x for a metre of reach"),
                     yielding("floor_y_rad_per_m", "rad/m", 1e-3, "tilt of the foot about y for a metre of reach"),
                     yielding("column_x_rad_per_m2", "rad/m^2", 1e-3, "bending about x for a metre of reach"),
                     yielding("column_y_rad_per_m2", "rad/m^2", 1e-3, "bending about y for a metre of reach")},
      .conditions = {"robot.reach", "robot.z"},
      .mistaken_for = {{.with = "robot.axis-scale", .told_apart = "hang a weight on the arm, and measure the same points"},
                       {.with = "robot.sag", .told_apart = "measure a point on the arm's base while it reaches out"},
                       {.with = "robot.joint-offset",
                        .told_apart = "measure a point on the arm's base while it reaches out"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
