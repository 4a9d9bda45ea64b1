// sensor.hot-pixel: a few pixels gather charge in the dark, each at a rate of its own.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& sensor_hot_pixel() {
  static const Mechanism declaration{
      .id = "sensor.hot-pixel",
      .sentence =
          "A few pixels gather much charge in the dark: they read more than their neighbours, the more the longer "
          "the exposure lasts.",
      .typical = "one pixel in 100 000 to one in 1000, up to full scale within seconds; twice as many every 6 to 8 K",
      .equation =
          "v += r exposure_s for a share of the pixels, always the same of a camera; r exponential with mean "
          "rate_per_s",
      .source = "EMVA Standard 1288, release 4.0, section on defect pixels; the law of r is ours",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"stacks"},
      .parameters = {{.name = "share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.1,
                      .start = 1e-4,
                      .typical = 1e-4,
                      .meaning = "of the pixels that are hot"},
                     {.name = "rate_per_s",
                      .unit = "W/(m^2 sr s)",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1e6,
                      .start = 0.1,
                      .meaning = "mean of what these gather in a second, in the unit of the readings"}},
      .conditions = {"image.exposure"},
      .mistaken_for = {{.with = "sensor.dark-current", .told_apart = "lens cap: all pixels gather it alike, or few do"},
                       {.with = "surface.spatial-variation",
                        .told_apart = "lens cap, or camera moved by a few pixels: hot ones stay where they are"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
