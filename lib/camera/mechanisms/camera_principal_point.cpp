// camera.principal-point: an optical axis that meets the sensor elsewhere than stated. On boards the base model frees
// cx and cy. Equation: scene/edits/camera_principal_point.cpp.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& camera_principal_point() {
  static const Mechanism declaration{
      .id = "camera.principal-point",
      .sentence =
          "The optical axis meets the sensor elsewhere than the camera section says: the whole "
          "picture is shifted.",
      .typical = "1 to 50 px; a crop by any number",
      .equation = "cx + x_px, cy + y_px",
      .source = "Hartley & Zisserman 2004, section 6.1",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"images", "clouds"},
      .parameters = {{.name = "x_px",
                      .unit = "px",
                      .lower = -100,
                      .upper = 100,
                      .start = 0.5,
                      .typical = 2,
                      .meaning = "shift along the rows"},
                     {.name = "y_px",
                      .unit = "px",
                      .lower = -100,
                      .upper = 100,
                      .start = 0.5,
                      .typical = 2,
                      .meaning = "shift along the columns"}},
      .conditions = {"camera.edge-shift-x", "camera.edge-shift-y"},
      .mistaken_for = {{.with = "camera.pose",
                        .told_apart = "roll the camera by 180 degrees, or photograph from several places"},
                       {.with = "board.corner-bias", .told_apart = "roll the camera by 180 degrees"},
                       {.with = "lens.tangential", .told_apart = "fill the corners of the image"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
