// robot.squareness: axes that are not at right angles.
#include "robot/mechanisms/robot_axes.h"

namespace gonio::mechanism {
namespace {

Parameter angle(const char* name, const char* meaning) {
  return {
      .name = name, .unit = "rad", .lower = -0.05, .upper = 0.05, .start = 1e-4, .typical = 3e-4, .meaning = meaning};
}

}  // namespace

const Mechanism& robot_squareness() {
  static const Mechanism declaration{
      .id = "robot.squareness",
      .sentence = "The machine's axes are not at right angles to each other.",
      .typical = "10 to 500 urad",
      .equation = "x' = x + xy_rad y + xz_rad z, y' = y + yz_rad z, z' = z",
      .source = "ISO 230-1:2012, section 9 (squareness); Schwenke et al., CIRP Annals 57(2), 2008, section 2",
      .stage = "pose",
      .target = Target::scene,
      .domains = {"tables"},
      .parameters = {angle("xy_rad", "by which y leans towards x"), angle("xz_rad", "by which z leans towards x"),
                     angle("yz_rad", "by which z leans towards y")},
      .conditions = {"robot.x", "robot.y", "robot.z"},
      .mistaken_for = {{.with = "robot.compliance",
                        .told_apart = "hang a weight on the arm, and measure the same points"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
