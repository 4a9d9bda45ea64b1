// lens.radial: the radial part of a real lens. Equation: camera/lens_terms.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& lens_radial() {
  static const Mechanism declaration{
      .id = "lens.radial",
      .sentence =
          "The lens magnifies differently towards the edge of the image: straight lines bow (barrel or pincushion).",
      .typical = "0.1 to 100 px at the corners",
      .equation = "(x', y') = (x, y) (1 + k1 r^2 + k2 r^4 + k3 r^6), r^2 = x^2 + y^2 in normalised coordinates",
      .source = "Brown 1971, equation 9; OpenCV's order and sign",
      .stage = "lens",
      .target = Target::camera,
      .domains = {"boards", "robot", "tables", "images", "clouds"},
      .parameters =
          {{.name = "k1", .unit = "1", .lower = -1, .upper = 1, .typical = 0.2, .meaning = "third-order radial term"},
           {.name = "k2", .unit = "1", .lower = -10, .upper = 10, .typical = 0.3, .meaning = "fifth-order radial term"},
           {.name = "k3",
            .unit = "1",
            .lower = -50,
            .upper = 50,
            .typical = 1,
            .meaning = "seventh-order radial term"}},
      .conditions = {"camera.image-radius", "camera.distance", "camera.edge-shift-radial"},
      .mistaken_for = {{.with = "board.warp",
                        .told_apart = "turn the board by 90 degrees, photograph it at two ranges"},
                       {.with = "lens.non-central", .told_apart = "photograph the board at two ranges"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
