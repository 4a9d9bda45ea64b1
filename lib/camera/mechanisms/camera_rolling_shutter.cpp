// camera.rolling-shutter: rows that are read one after the other while board or camera move. Equation:
// camera/corner_model.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& camera_rolling_shutter() {
  static const Mechanism declaration{
      .id = "camera.rolling-shutter",
      .sentence =
          "The rows are read one after the other, and board or camera moved meanwhile: each photograph is sheared and "
          "stretched on its own.",
      .typical = "0.1 to 10 px",
      .equation =
          "the board of each view stands at t + tau (motion_x_m, motion_y_m, 0) when row v is read, tau = (v - (h - 1) "
          "/ 2) / h for an image of h rows",
      .source = "Oth, Furgale, Kneip & Siegwart, Rolling shutter camera calibration, CVPR 2013 (constant velocity)",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"boards", "images"},
      .parameters =
          {{.name = "motion_x_m",
            .unit = "m",
            .lower = -0.1,
            .upper = 0.1,
            .typical = 1e-3,
            .meaning = "shift of the board along the camera's x during one readout, one number for each image in on"},
           {.name = "motion_y_m",
            .unit = "m",
            .lower = -0.1,
            .upper = 0.1,
            .typical = 1e-3,
            .meaning = "the same along its y"}},
      .conditions = {"camera.image-y", "camera.image-x", "camera.edge-shift-x", "camera.edge-shift-y"},
      .mistaken_for = {{.with = "pose noise", .told_apart = "stop before each photograph"},
                       {.with = "board.warp", .told_apart = "rest camera and board on stands and photograph again"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
