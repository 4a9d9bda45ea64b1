// lens.rational: a wide lens whose distortion a short polynomial cannot follow. Equation: camera/lens_terms.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& lens_rational() {
  static const Mechanism declaration{
      .id = "lens.rational",
      .sentence =
          "Towards the edge of a wide lens the magnification changes faster than a polynomial of three terms follows.",
      .typical = "0.1 to 100 px at the corners",
      .equation = "(x', y') = (x, y) (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)",
      .source = "OpenCV's rational model, calib3d; after Claus & Fitzgibbon, CVPR 2005",
      .stage = "lens",
      .target = Target::camera,
      .domains = {"boards", "images"},
      .parameters = {{.name = "k4",
                      .unit = "1",
                      .lower = -1,
                      .upper = 1,
                      .typical = 0.2,
                      .meaning = "second-order term of the denominator"},
                     {.name = "k5",
                      .unit = "1",
                      .lower = -10,
                      .upper = 10,
                      .typical = 0.5,
                      .meaning = "fourth-order term of the denominator"},
                     {.name = "k6",
                      .unit = "1",
                      .lower = -50,
                      .upper = 50,
                      .typical = 1,
                      .meaning = "sixth-order term of the denominator"}},
      .conditions = {"camera.image-radius", "camera.edge-shift-radial"},
      .mistaken_for = {{.with = "lens.radial", .told_apart = "fill the corners of the image"},
                       {.with = "lens.fisheye", .told_apart = "fill the corners of the image"},
                       {.with = "board.warp",
                        .told_apart = "turn the board by 90 degrees, photograph it at two ranges"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
