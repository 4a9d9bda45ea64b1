// robot.axis-scale: axes that are longer or shorter than their scales say.
#include "robot/mechanisms/robot_axes.h"

namespace gonio::mechanism {
namespace {

Parameter share(const char* name, const char* meaning) {
  return {.name = name, .unit = "1", .lower = -0.05, .upper = 0.05, .start = 1e-4, .typical = 3e-4, .meaning = meaning};
}

}  // namespace

const Mechanism& robot_axis_scale() {
  static const Mechanism declaration{
      .id = "robot.axis-scale",
      .sentence = "The machine's way is longer or shorter than its scales say, in proportion to the way.",
      .typical = "20 to 500 um/m",
      .equation = "x' = (1 + scale_x) x, y' = (1 + scale_y) y, z' = (1 + scale_z) z",
      .source = "ISO 230-1:2012, section 8.3 (positioning errors); Schwenke et al., CIRP Annals 57(2), 2008, section 2",
      .stage = "pose",
      .target = Target::scene,
      .domains = {"tables"},
      .parameters = {share("scale_x", "share by which ways along x are longer"),
                     share("scale_y", "share by which ways along y are longer"),
                     share("scale_z", "share by which ways along z are longer")},
      .conditions = {"robot.x", "robot.y", "robot.z"},
      .mistaken_for = {{.with = "robot.compliance",
                        .told_apart = "hang a weight on the arm, and measure the same points"},
                       {.with = "robot.thermal", .told_apart = "measure the same points cold and warm"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
