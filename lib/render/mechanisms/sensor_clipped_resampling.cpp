// sensor.clipped-resampling: pixels are mixed after they were clipped.
#include "render/mechanisms/sensor_clipped_resampling.h"

namespace gonio::mechanism {

const Mechanism& sensor_clipped_resampling() {
  static const Mechanism declaration{
      .id = "sensor.clipped-resampling",
      .sentence =
          "Highlights were cut off at full scale before the picture was resampled: what they lost is missing around "
          "them.",
      .typical = "up to 27 % at the edges of highlights (measured)",
      .equation = "v(x) = mean over a box of width_px native pixels about x of min(v, full_scale)",
      .source = "Debevec & Malik 1997, section 2.1 (saturated pixels hold no value); box filter, Heckbert 1989",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"images"},
      .parameters = {{.name = "full_scale",
                      .unit = "W/(m^2 sr)",
                      .neutral = 0,
                      .lower = 1e-09,
                      .upper = 1000000000.0,
                      .start = 1,
                      .meaning = "largest native reading, in the unit of the picture; 0: no limit"},
                     {.name = "width_px",
                      .unit = "px",
                      .neutral = 1,
                      .lower = 1,
                      .upper = 3,
                      .start = 1.8,
                      .typical = 1,
                      .meaning = "side of the box of native pixels that one pixel of the picture is made of; without "
                                 "effect where nothing is cut off"}},
      .conditions = {"image.radiance", "image.edge-distance"},
      .mistaken_for = {{.with = "sensor.non-linearity", .told_apart = "native pixels; or a shorter exposure"},
                       {.with = "sensor.saturation", .told_apart = "native pixels"},
                       {.with = "optics.defocus", .told_apart = "a shorter exposure"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
