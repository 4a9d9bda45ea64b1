// camera.thermal: a camera that drifts while it warms up. Equation: camera/corner_model.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& camera_thermal() {
  static const Mechanism declaration{
      .id = "camera.thermal",
      .sentence =
          "Focal length and principal point drift with the camera's temperature, or with time while it warms up.",
      .typical = "0.14 px / K (reported)",
      .equation =
          "f (1 + focal_per_K dT), c + (x_px_per_K, y_px_per_K) dT with dT = T - mean(T) over the recordings; where "
          "they state no temperature, the same with time and per second. Views that state the same camera_from_board "
          "to "
          "the last digit are of a fixed target: they share one pose",
      .source = "Handel, ACCV 2007 (warm-up of cameras); here linear in temperature or time",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"boards", "clouds"},
      .parameters =
          {{.name = "focal_per_K",
            .unit = "1/K",
            .lower = -1e-3,
            .upper = 1e-3,
            .typical = 2e-5,
            .meaning = "stretch of fx and fy"},
           {.name = "x_px_per_K", .unit = "px/K", .lower = -3, .upper = 3, .typical = 0.14, .meaning = "drift of cx"},
           {.name = "y_px_per_K", .unit = "px/K", .lower = -3, .upper = 3, .typical = 0.14, .meaning = "drift of cy"},
           {.name = "focal_per_s",
            .unit = "1/s",
            .lower = -1e-4,
            .upper = 1e-4,
            .typical = 2e-7,
            .meaning = "stretch of fx and fy"},
           {.name = "x_px_per_s",
            .unit = "px/s",
            .lower = -0.3,
            .upper = 0.3,
            .typical = 0.002,
            .meaning = "drift of cx"},
           {.name = "y_px_per_s",
            .unit = "px/s",
            .lower = -0.3,
            .upper = 0.3,
            .typical = 0.002,
            .meaning = "drift of cy"}},
      .conditions = {"camera.temperature", "camera.temperature-in-x", "camera.temperature-in-y", "camera.time",
                     "camera.time-in-x", "camera.time-in-y"},
      .mistaken_for = {{.with = "robot.sag", .told_apart = "photograph a fixed target while the camera warms up"},
                       {.with = "board pose", .told_apart = "leave camera and board on stands from image to image"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
