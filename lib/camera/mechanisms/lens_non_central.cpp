// lens.non-central: rays that do not meet in one point. Equation: camera/corner_model.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& lens_non_central() {
  static const Mechanism declaration{
      .id = "lens.non-central",
      .sentence =
          "The rays do not meet in one point: the entrance pupil moves along the axis with the angle of the ray, so "
          "that near things are drawn at another image radius than far ones.",
      .typical = "0.05 to 1 px; pupils move by millimetres",
      .equation =
          "the ray at the angle theta from the axis passes through (0, 0, pupil_m sin^2 theta): (X, Y, Z) is seen "
          "where "
          "a central lens sees (X, Y, Z - pupil_m sin^2 theta)",
      .source = "Gennery, IJCV 68(3), 2006 (moving entrance pupil), to first order in theta^2",
      .stage = "optics",
      .target = Target::camera,
      .domains = {"boards", "images"},
      .parameters = {{.name = "pupil_m",
                      .unit = "m",
                      .lower = -0.05,
                      .upper = 0.05,
                      .typical = 0.005,
                      .meaning = "shift of the entrance pupil towards the scene at 90 degrees from the axis"}},
      .conditions = {"camera.image-radius-over-distance", "camera.distance", "camera.image-radius",
                     "camera.edge-shift-radial"},
      .mistaken_for = {{.with = "board.warp", .told_apart = "photograph the board at two ranges"},
                       {.with = "lens.radial", .told_apart = "photograph the board at two ranges"},
                       {.with = "lens.fisheye", .told_apart = "photograph the board at two ranges"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
