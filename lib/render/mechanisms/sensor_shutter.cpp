// sensor.shutter: the exposure is not what was set. It acts on images that state their exposure.
#include "render/mechanisms/sensor_shutter.h"

namespace gonio::mechanism {

const Mechanism& sensor_shutter() {
  static const Mechanism declaration{
      .id = "sensor.shutter",
      .sentence = "The shutter stays open a fixed time longer (or shorter) than was set.",
      .typical = "0.1 to 3 % of short exposures",
      .equation = "v *= (exposure_s + extra_s) / exposure_s",
      .source = "EMVA Standard 1288, release 4.0, section 6 (exposure time as the independent variable)",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"tables", "stacks", "images"},
      .parameters = {{.name = "extra_s",
                      .unit = "s",
                      .neutral = 0,
                      .lower = -0.01,
                      .upper = 0.01,
                      .start = 1e-5,
                      .typical = 5e-5,
                      .meaning = "time by which every exposure is longer than stated"}},
      .conditions = {"image.exposure"},
      .mistaken_for = {{.with = "light.drift", .told_apart = "the exposures in shuffled order, some of them twice"},
                       {.with = "sensor.black-offset", .told_apart = "lens cap: an offset stays"}},
      .inputs = {{.name = "exposure_s", .unit = "s", .lower = 1e-4, .upper = 10}},
      .act = [](double v, std::span<const double> at,
                std::span<const double> p) { return equation::sensor_shutter(v, p[0], at[0]); },
  };
  return declaration;
}

}  // namespace gonio::mechanism
