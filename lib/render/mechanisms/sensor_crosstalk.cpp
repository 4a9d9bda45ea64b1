// sensor.crosstalk: bands leak into each other.
#include "render/mechanisms/sensor_crosstalk.h"

namespace gonio::mechanism {

const Mechanism& sensor_crosstalk() {
  static const Mechanism declaration{
      .id = "sensor.crosstalk",
      .sentence = "Colour filters and neighbouring pixels let some of the other colours through.",
      .typical = "1 to 5 %",
      .equation =
          "(R, G, B)' = M (R, G, B), M = 1 - 2 share on the diagonal and share elsewhere; of a polarization camera "
          "reading' = (1 - 4 share) reading + share (sum of the four beside it)",
      .source = "Hirakawa 2008, Cross-talk explained (symmetric; the spatial part behind polarizers alone)",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"images", "polarization"},
      .parameters = {{.name = "share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.2,
                      .start = 0.03,
                      .typical = 0.03,
                      .meaning =
                          "share of each other band in a band's reading, or of each sample beside one in its own"}},
      .conditions = {"image.hue", "sensor.neighbours"},
      .mistaken_for = {{.with = "dispersion", .told_apart = "light of one colour"},
                       {.with = "surface albedo", .told_apart = "light of one colour"},
                       {.with = "polarizer.leak", .told_apart = "an edge between dark and bright"}},
      .inputs = {{.name = "sum", .unit = "W/(m^2 sr)", .lower = 0, .upper = 30}},
      .act = [](double v, std::span<const double> at,
                std::span<const double> p) { return equation::sensor_crosstalk(v, p[0], at[0]); },
  };
  return declaration;
}

}  // namespace gonio::mechanism
