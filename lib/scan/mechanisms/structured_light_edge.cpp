// structured-light.edge: places of the brighter side. Equation: structured_light_edge.h.
#include "scan/mechanisms/structured_light_edge.h"

#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& structured_light_edge() {
  static const Mechanism declaration{
      .id = "structured-light.edge",
      .sentence =
          "A pixel of the camera sees light from around it, and most of the brighter side: where print or shading "
          "changes, points tell the place beside theirs.",
      .typical = "0.1 px^2 of a sharp lens, a pixel's own square, to 2 px^2 out of focus",
      .equation =
          "phase turned by arg I(x + i spread_px2 k), I what white adds at the pixel x, continued to complex places, k "
          "the phase's change per pixel; of long periods: lit at x + spread_px2 grad log I(x)",
      .source = "Curless & Levoy 1995 (reflectance changes); Robbins 1956 (mean of what a Gaussian blurred)",
      .stage = "light",
      .target = Target::camera,
      .domains = {"clouds"},
      .parameters = {{.name = "spread_px2",
                      .unit = "px^2",
                      .lower = -4,
                      .upper = 25,
                      .start = 0.3,
                      .typical = 0.5,
                      .meaning =
                          "variance along x and y of a point's picture; negative where pictures were sharpened"}},
      .conditions = {"camera.brightness-slope"},
      .mistaken_for = {{.with = "projector.gamma", .told_apart = "measure something of one colour"},
                       {.with = "structured-light.subsurface", .told_apart = "turn the printed thing upside down"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
