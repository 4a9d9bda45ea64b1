// lens.tangential: lens elements that are not centred on one axis. Equation: camera/lens_terms.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& lens_tangential() {
  static const Mechanism declaration{
      .id = "lens.tangential",
      .sentence = "The lens elements are decentred, so that distortion differs between opposite sides of the image.",
      .typical = "0.1 to 5 px",
      .equation = "x' += 2 p1 x y + p2 (r^2 + 2 x^2), y' += p1 (r^2 + 2 y^2) + 2 p2 x y",
      .source = "Brown 1971, equation 9; OpenCV's order and sign",
      .stage = "lens",
      .target = Target::camera,
      .domains = {"boards", "robot", "images", "clouds"},
      .parameters = {{.name = "p1",
                      .unit = "1",
                      .lower = -0.5,
                      .upper = 0.5,
                      .typical = 0.002,
                      .meaning = "decentring along the rows' normal"},
                     {.name = "p2",
                      .unit = "1",
                      .lower = -0.5,
                      .upper = 0.5,
                      .typical = 0.002,
                      .meaning = "decentring along the columns' normal"}},
      .conditions = {"camera.image-azimuth", "camera.image-radius", "camera.obliqueness", "camera.edge-shift-x",
                     "camera.edge-shift-y"},
      .mistaken_for = {{.with = "lens.thin-prism",
                        .told_apart = "fill the corners of the image; the prism has no r^2 + 2 x^2"},
                       {.with = "board.warp",
                        .told_apart = "turn the board by 90 degrees, photograph it at two ranges"},
                       {.with = "board.corner-bias", .told_apart = "roll the camera by 180 degrees"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
