// lens.fisheye: a projection between the perspective and the equidistant one. Equation: camera/lens_terms.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& lens_fisheye() {
  static const Mechanism declaration{
      .id = "lens.fisheye",
      .sentence =
          "The lens does not project perspectively: the edge of its image is drawn closer than the tangent of the "
          "angle "
          "demands, as in a fisheye.",
      .typical = "up to hundreds of px",
      .equation = "r = tan(L theta) / L, L = 1 - fisheye, theta the angle from the axis",
      .source = "Gennery, IJCV 68(3), 2006, section 3",
      .stage = "lens",
      .target = Target::camera,
      .domains = {"boards", "images"},
      .parameters = {{.name = "fisheye",
                      .unit = "1",
                      .lower = 0,
                      .upper = 1,
                      .typical = 0.5,
                      .meaning = "from perspective (0) to equidistant (1) projection"}},
      .conditions = {"camera.image-radius", "camera.edge-shift-radial"},
      .mistaken_for = {{.with = "lens.radial", .told_apart = "fill the corners of the image"},
                       {.with = "lens.rational", .told_apart = "fill the corners of the image"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
