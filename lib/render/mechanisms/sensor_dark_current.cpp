// sensor.dark-current: what gathers in the dark, for as long as the exposure lasts.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& sensor_dark_current() {
  static const Mechanism declaration{
      .id = "sensor.dark-current",
      .sentence = "The sensor gathers charge in the dark, the more the longer the exposure lasts.",
      .typical = "0.1 to 100 electrons a second and pixel at 20 degrees Celsius, twice as many every 6 to 8 K",
      .equation = "v += rate_per_s exposure_s",
      .source = "EMVA Standard 1288, release 4.0, equation 9 (dark current)",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"tables"},
      .parameters = {{.name = "rate_per_s",
                      .unit = "W/(m^2 sr s)",
                      .neutral = 0,
                      .lower = -1000,
                      .upper = 1000,
                      .start = 0.01,
                      .meaning = "reading that gathers in a second without light, in the unit of the readings"}},
      .conditions = {"image.exposure"},
      .mistaken_for = {{.with = "sensor.black-offset", .told_apart = "lens cap, at two exposures: an offset stays"},
                       {.with = "light.ambient",
                        .told_apart = "lens cap, at the longest exposure: without it the two are one"}},
      .inputs = {{.name = "exposure_s", .unit = "s", .lower = 1e-4, .upper = 10}},
      .act = [](double v, std::span<const double> at, std::span<const double> p) { return v + p[0] * at[0]; },
  };
  return declaration;
}

}  // namespace gonio::mechanism
