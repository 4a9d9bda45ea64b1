// projector.moved: a projector that stands elsewhere in its rig than stated. Equation: camera.pose's, of a rig's
// member.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& projector_moved() {
  static const Mechanism declaration{
      .id = "projector.moved",
      .sentence =
          "The projector stands or looks elsewhere than the rig says: it was nudged since it was calibrated, or its "
          "zoom or shift was touched.",
      .typical = "0.1 to 2 mm, 0.01 to 0.5 degrees",
      .equation =
          "rig_from_projector (x_m, y_m, z_m; turn_x_rad, turn_y_rad, turn_z_rad): first the turn about the axis of "
          "that vector, then the shift, both in the frame of the stated projector",
      .source = "Hartley & Zisserman 2004, section 6.1; Rodrigues for the turn",
      .stage = "pose",
      .target = Target::camera,
      .domains = {"clouds"},
      .parameters = {{.name = "turn_x_rad",
                      .unit = "rad",
                      .lower = -0.1,
                      .upper = 0.1,
                      .start = 0.002,
                      .typical = 0.002,
                      .meaning = "turn about the projector's x"},
                     {.name = "turn_y_rad",
                      .unit = "rad",
                      .lower = -0.1,
                      .upper = 0.1,
                      .start = 0.002,
                      .typical = 0.002,
                      .meaning = "turn about the projector's y"},
                     {.name = "turn_z_rad",
                      .unit = "rad",
                      .lower = -0.1,
                      .upper = 0.1,
                      .start = 0.002,
                      .typical = 0.002,
                      .meaning = "turn about the projector's z"},
                     {.name = "x_m",
                      .unit = "m",
                      .lower = -0.05,
                      .upper = 0.05,
                      .start = 0.001,
                      .typical = 0.001,
                      .meaning = "shift along the projector's x"},
                     {.name = "y_m",
                      .unit = "m",
                      .lower = -0.05,
                      .upper = 0.05,
                      .start = 0.001,
                      .typical = 0.001,
                      .meaning = "shift along the projector's y"},
                     {.name = "z_m",
                      .unit = "m",
                      .lower = -0.05,
                      .upper = 0.05,
                      .start = 0.001,
                      .typical = 0.001,
                      .meaning = "shift along the projector's z"}},
      .conditions = {"scene.depth", "projector.image-radius", "camera.image-x", "camera.image-y"},
      .mistaken_for = {{.with = "rig.drift", .told_apart = "measure the same thing again after an hour"},
                       {.with = "projector.lens", .told_apart = "measure a plane at two ranges"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
