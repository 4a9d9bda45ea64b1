// sensor.prnu: pixels differ in their sensitivity.
#include "render/mechanisms/sensor_prnu.h"

namespace gonio::mechanism {

const Mechanism& sensor_prnu() {
  static const Mechanism declaration{
      .id = "sensor.prnu",
      .sentence = "Pixels differ in sensitivity, always in the same way: a pattern that stays with the sensor.",
      .typical = "0.3 to 5 %",
      .equation = "v *= 1 + sigma n(pixel), n standard normal and fixed for each pixel and colour of a camera",
      .source = "EMVA Standard 1288, release 4.0, PRNU_1288; Janesick 2007, chapter 3",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"images"},
      .parameters = {{.name = "sigma",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.1,
                      .start = 0.01,
                      .typical = 0.01,
                      .meaning = "standard deviation of the pixels' sensitivity over its mean"}},
      .conditions = {"camera.pixel"},
      .mistaken_for = {{.with = "texture", .told_apart = "shift the object by some pixels: the pattern stays"},
                       {.with = "sensor.row-pattern", .told_apart = "direct current for the lamps: rows vanish"}},
      .inputs = {{.name = "normal_of_pixel", .unit = "1", .lower = -12, .upper = 12}},
      .act = [](double v, std::span<const double> at,
                std::span<const double> p) { return equation::sensor_prnu(v, p[0], at[0]); },
  };
  return declaration;
}

}  // namespace gonio::mechanism
