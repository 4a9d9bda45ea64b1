// sensor.blooming: one step from pixel to pixel. What flows over and is not caught by the drain goes to the four next
// to it; what these cannot hold in turn is not passed on.
#include "render/mechanisms/sensor_blooming.h"

namespace gonio::mechanism {

const Mechanism& sensor_blooming() {
  static const Mechanism declaration{
      .id = "sensor.blooming",
      .sentence =
          "What a full pixel cannot hold flows into the pixels beside it: next to what is clipped, readings are "
          "too high.",
      .typical = "0.1 to 3 % of what flows over, into each neighbour; the more along the direction of read-out",
      .equation =
          "v += along (o_up + o_down) + across (o_left + o_right), o = max(0, v - full_scale) of the neighbour, "
          "whatever its filter; full_scale 0: none flows over",
      .source =
          "Theuwissen 1995, Solid-State Imaging with Charge-Coupled Devices, on blooming and drains against it "
          "(one step, linear)",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"stacks"},
      .parameters = {{.name = "along",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.25,
                      .start = 0.005,
                      .typical = 0.01,
                      .meaning = "share of the overflow that reaches each neighbour in the column"},
                     {.name = "across",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.25,
                      .start = 0.005,
                      .typical = 0.01,
                      .meaning = "the same for each neighbour in the row"},
                     {.name = "full_scale",
                      .unit = "W/(m^2 sr)",
                      .neutral = 0,
                      .lower = 1e-09,
                      .upper = 1000000000.0,
                      .start = 1,
                      .meaning = "what a pixel holds, in the unit of the picture"}},
      .conditions = {"sensor.overflow"},
      .mistaken_for = {{.with = "sensor.crosstalk",
                        .told_apart = "an exposure at which nothing is clipped: crosstalk stays, blooming is gone"},
                       {.with = "optics.bloom",
                        .told_apart = "an exposure at which nothing is clipped: a halo stays, blooming is gone"},
                       {.with = "sensor.saturation", .told_apart = "an exposure at which nothing is clipped"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
