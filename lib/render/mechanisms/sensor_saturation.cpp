// sensor.saturation: readings have a largest value.
#include "render/mechanisms/sensor_saturation.h"

namespace gonio::mechanism {

const Mechanism& sensor_saturation() {
  static const Mechanism declaration{
      .id = "sensor.saturation",
      .sentence = "The sensor reads no more than its full scale, whatever light arrives.",
      .typical = "whatever passes full scale",
      .equation = "v = min(v, full_scale), in the mean over the noise that was there before; full_scale 0: no limit",
      .source = "EMVA Standard 1288, release 4.0, saturation capacity",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"tables", "stacks", "images"},
      .parameters = {{.name = "full_scale",
                      .unit = "W/(m^2 sr)",
                      .neutral = 0,
                      .lower = 1e-09,
                      .upper = 1000000000.0,
                      .start = 1,
                      .meaning = "largest reading, in the unit of the picture"}},
      .conditions = {"image.radiance"},
      .mistaken_for = {{.with = "sensor.non-linearity", .told_apart = "shorter exposure"},
                       {.with = "surface.specular", .told_apart = "shorter exposure"}},
      .act = [](double v, std::span<const double>,
                std::span<const double> p) { return equation::sensor_saturation(v, p[0]); },
  };
  return declaration;
}

}  // namespace gonio::mechanism
