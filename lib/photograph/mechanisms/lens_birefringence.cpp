// lens.birefringence: glass under stress before the sensor.
#include "photograph/mechanisms/lens_birefringence.h"

namespace gonio::mechanism {

const Mechanism& lens_birefringence() {
  static const Mechanism declaration{
      .id = "lens.birefringence",
      .sentence = "Stress in the lens delays light that swings along the radius, the more the farther out.",
      .typical = "5 to 60 degrees at the edge of moulded and clamped lenses",
      .equation =
          "a linear retarder before the polarizers, its axis along the radius, retardance = retardance_rad r^2, "
          "r the distance from where the axis meets the picture over half its width",
      .source =
          "Collett 2005, equation 5-27 (retarder); Chipman, Lam & Young 2018, section 22.3 (stress of a mount: "
          "radial, grows with the radius squared)",
      .stage = "optics",
      .target = Target::camera,
      .domains = {"polarization"},
      .parameters = {{.name = "retardance_rad",
                      .unit = "rad",
                      .neutral = 0,
                      .lower = -2,
                      .upper = 2,
                      .start = 0.4,
                      .typical = 0.3,
                      .meaning = "half a picture's width from the axis: delay of light along the radius"}},
      .conditions = {"camera.image-radius"},
      .mistaken_for = {{.with = "polarizer.leak", .told_apart = "the middle of the picture"},
                       {.with = "polarizer.angle", .told_apart = "the middle of the picture"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
