// lens.thin-prism: a tilted sensor or lens element. Equation: camera/lens_terms.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& lens_thin_prism() {
  static const Mechanism declaration{
      .id = "lens.thin-prism",
      .sentence =
          "A slightly tilted lens element or sensor acts like a thin prism and shifts the image with the square of the "
          "radius.",
      .typical = "0.1 to 5 px",
      .equation = "x' += s1 r^2 + s2 r^4, y' += s3 r^2 + s4 r^4",
      .source = "Weng, Cohen & Herniou 1992, equation 13, with the r^4 terms of OpenCV",
      .stage = "lens",
      .target = Target::camera,
      .domains = {"boards", "robot", "images"},
      .parameters =
          {{.name = "s1", .unit = "1", .lower = -0.5, .upper = 0.5, .typical = 0.002, .meaning = "shift of x with r^2"},
           {.name = "s2", .unit = "1", .lower = -0.5, .upper = 0.5, .typical = 0.01, .meaning = "shift of x with r^4"},
           {.name = "s3", .unit = "1", .lower = -0.5, .upper = 0.5, .typical = 0.002, .meaning = "shift of y with r^2"},
           {.name = "s4", .unit = "1", .lower = -0.5, .upper = 0.5, .typical = 0.01, .meaning = "shift of y with r^4"}},
      .conditions = {"camera.image-azimuth", "camera.image-radius", "camera.obliqueness", "camera.edge-shift-x",
                     "camera.edge-shift-y"},
      .mistaken_for = {{.with = "lens.tangential",
                        .told_apart = "fill the corners of the image; the prism has no r^2 + 2 x^2"},
                       {.with = "board.warp",
                        .told_apart = "turn the board by 90 degrees, photograph it at two ranges"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
