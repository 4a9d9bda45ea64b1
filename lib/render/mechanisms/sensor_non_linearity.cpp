// sensor.non-linearity: the reading bends away from the light. Equation: render/sensor_chain.h, step 6.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& sensor_non_linearity() {
  static const Mechanism declaration{
      .id = "sensor.non-linearity",
      .sentence = "The reading does not grow in proportion to the light.",
      .typical = "0.3 to 2 % (film and JPEG: far more)",
      .equation = "v *= 1 + quadratic v / reference",
      .source = "EMVA Standard 1288, release 4.0, linearity (second order)",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {},
      .parameters = {{.name = "quadratic",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.5,
                      .upper = 0.5,
                      .start = -0.02,
                      .meaning = "relative departure from proportionality at the value reference"},
                     {.name = "reference",
                      .unit = "W/(m^2 sr)",
                      .neutral = 1,
                      .lower = 1e-06,
                      .upper = 1000000.0,
                      .start = 1,
                      .meaning = "value at which the departure is stated; without effect where quadratic is 0"}},
      .conditions = {"image.radiance"},
      .mistaken_for = {{.with = "surface.specular", .told_apart = "exposure ramp"},
                       {.with = "sensor.saturation", .told_apart = "shorter exposure"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
