// light.drift: lamps change as they warm up. It acts on images that state their time.
#include "light/mechanisms/light_drift.h"

namespace gonio::mechanism {

const Mechanism& light_drift() {
  static const Mechanism declaration{
      .id = "light.drift",
      .sentence = "The lamp's output changes while it warms up.",
      .typical = "1 to 10 %",
      .equation = "intensity *= 1 + amplitude exp(-t / time_constant_s), t the time since the first recording",
      .source = "first-order thermal response; CIE 198:2011, stabilisation of lamps",
      .stage = "light",
      .target = Target::scene,
      .domains = {"tables", "stacks", "images"},
      .parameters = {{.name = "amplitude",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.5,
                      .upper = 0.5,
                      .start = 0.02,
                      .typical = 0.05,
                      .meaning = "relative excess of the light at the first recording over the warm lamp"},
                     {.name = "time_constant_s",
                      .unit = "s",
                      .neutral = 600,
                      .lower = 0.001,
                      .upper = 1e6,
                      .start = 600,
                      .typical = 600,
                      .meaning = "in which the excess falls to 37 %; without effect at amplitude 0"}},
      .conditions = {"image.time"},
      .mistaken_for = {{.with = "sensor.shutter",
                        .told_apart = "interleave a reference patch, or shuffle the exposures"},
                       {.with = "camera.thermal", .told_apart = "a second lamp that is warm already"}},
      .inputs = {{.name = "time_s", .unit = "s", .lower = 0, .upper = 1e4}},
      .act = [](double v, std::span<const double> at,
                std::span<const double> p) { return v * equation::light_drift(p[0], p[1], at[0]); },
  };
  return declaration;
}

}  // namespace gonio::mechanism
