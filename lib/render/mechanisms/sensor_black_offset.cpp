// sensor.black-offset: readings without light.
#include "render/mechanisms/sensor_black_offset.h"

namespace gonio::mechanism {

const Mechanism& sensor_black_offset() {
  static const Mechanism declaration{
      .id = "sensor.black-offset",
      .sentence = "The sensor reads more than zero in the dark.",
      .typical = "1 to 10 codes",
      .equation = "v += offset",
      .source = "EMVA Standard 1288, release 4.0, dark signal",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"tables", "stacks", "images"},
      .parameters = {{.name = "offset",
                      .unit = "W/(m^2 sr)",
                      .neutral = 0,
                      .lower = -1000,
                      .upper = 1000,
                      .start = 0.01,
                      .meaning = "reading in the dark, in the unit of the picture"}},
      .conditions = {"image.radiance", "image.exposure"},
      .mistaken_for = {{.with = "light.ambient", .told_apart = "lens cap, or the same scene at two exposures"},
                       {.with = "optics.veiling-glare", .told_apart = "lens cap"}},
      .act = [](double v, std::span<const double>,
                std::span<const double> p) { return equation::sensor_black_offset(v, p[0]); },
  };
  return declaration;
}

}  // namespace gonio::mechanism
