// sensor.exposure: single pictures that are brighter or darker than their neighbours, each by a number of its own.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& sensor_exposure() {
  static const Mechanism declaration{
      .id = "sensor.exposure",
      .sentence = "Single pictures were exposed longer or shorter than was written down, or their lamps flickered.",
      .typical = "1 to 20 %, in a few pictures",
      .equation = "v *= 1 + relative, a number for each picture",
      .source = "EMVA Standard 1288, release 4.0, section 6 (exposure time as the independent variable)",
      .stage = "sensor",
      .target = Target::scene,
      .domains = {"images", "stacks"},
      .parameters = {{.name = "relative",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.6,
                      .upper = 1.5,
                      .start = 0.02,
                      .typical = 0.05,
                      .meaning = "by which the picture is brighter than its exposure and its lamps say"}},
      .conditions = {"image.identity", "image.exposure", "image.time"},
      .mistaken_for = {{.with = "light.drift", .told_apart = "the same pictures again, in another order"},
                       {.with = "sensor.shutter",
                        .told_apart = "the same exposures again: the shutter repeats its error"},
                       {.with = "light.position", .told_apart = "a second object at another distance from the lamp"}},
      .inputs = {},
      .act = [](double v, std::span<const double>, std::span<const double> p) { return v * (1 + p[0]); },
  };
  return declaration;
}

}  // namespace gonio::mechanism
