// camera.pose: a camera that stands elsewhere than stated. On boards every view has a pose of its own in the base
// model. Equation: scene/edits/camera_pose.cpp.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& camera_pose() {
  static const Mechanism declaration{
      .id = "camera.pose",
      .sentence =
          "The camera stands or looks elsewhere than its stated pose: it was nudged, or its place "
          "on its holder is another.",
      .typical = "0.1 to 5 mm, 0.01 to 1 degree",
      .equation =
          "world_from_camera (x_m, y_m, z_m; turn_x_rad, turn_y_rad, turn_z_rad): first the turn "
          "about the axis of that vector, then the shift, both in the frame of the stated camera",
      .source = "Hartley & Zisserman 2004, section 6.1; Rodrigues for the turn",
      .stage = "pose",
      .target = Target::camera,
      .domains = {"images", "clouds"},
      .parameters = {{.name = "x_m",
                      .unit = "m",
                      .lower = -0.2,
                      .upper = 0.2,
                      .start = 0.001,
                      .typical = 0.001,
                      .meaning = "shift along the camera's x"},
                     {.name = "y_m",
                      .unit = "m",
                      .lower = -0.2,
                      .upper = 0.2,
                      .start = 0.001,
                      .typical = 0.001,
                      .meaning = "shift along the camera's y"},
                     {.name = "z_m",
                      .unit = "m",
                      .lower = -0.2,
                      .upper = 0.2,
                      .start = 0.001,
                      .typical = 0.001,
                      .meaning = "shift along the camera's z"},
                     {.name = "turn_x_rad",
                      .unit = "rad",
                      .lower = -0.3,
                      .upper = 0.3,
                      .start = 0.002,
                      .typical = 0.002,
                      .meaning = "turn about the camera's x"},
                     {.name = "turn_y_rad",
                      .unit = "rad",
                      .lower = -0.3,
                      .upper = 0.3,
                      .start = 0.002,
                      .typical = 0.002,
                      .meaning = "turn about the camera's y"},
                     {.name = "turn_z_rad",
                      .unit = "rad",
                      .lower = -0.3,
                      .upper = 0.3,
                      .start = 0.002,
                      .typical = 0.002,
                      .meaning = "turn about the camera's z"}},
      .conditions = {"camera.edge-shift-x", "camera.edge-shift-y", "scene.depth"},
      .mistaken_for = {{.with = "geometry.pose", .told_apart = "photograph several objects, or from a second place"},
                       {.with = "camera.principal-point",
                        .told_apart = "roll the camera by 180 degrees, or photograph from several places"},
                       {.with = "camera.focal-length", .told_apart = "photograph from two ranges"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
