// sensor.row-pattern: flicker under a rolling shutter.
#include "render/mechanisms/sensor_row_pattern.h"

namespace gonio::mechanism {

const Mechanism& sensor_row_pattern() {
  static const Mechanism declaration{
      .id = "sensor.row-pattern",
      .sentence = "Lamps flicker while the rows are read one after the other, and the picture shows bands.",
      .typical = "1 to 20 %",
      .equation = "v *= 1 + amplitude sin(a + phase_rad) + sine sin(a) + cosine cos(a), a = 2 pi row / period_px",
      .source = "first harmonic of mains flicker; Sheinin, Schechner & Kutulakos 2017",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"tables", "images"},
      .parameters = {{.name = "amplitude",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.5,
                      .start = 0.05,
                      .typical = 0.1,
                      .meaning = "half the swing over the mean"},
                     {.name = "period_px",
                      .unit = "px",
                      .neutral = 100,
                      .lower = 2,
                      .upper = 100000.0,
                      .start = 100,
                      .meaning = "rows from band to band: 1 / (2 mains frequency) over the time from row to row"},
                     {.name = "phase_rad",
                      .unit = "rad",
                      .neutral = 0,
                      .lower = -6.283185307179586,
                      .upper = 6.283185307179586,
                      .start = 0,
                      .meaning = "phase at row 0; changes from picture to picture"},
                     {.name = "sine",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.35,
                      .upper = 0.35,
                      .start = 0,
                      .typical = 0.05,
                      .meaning = "for pictures with a phase of their own (name them in \"on\"): the part that begins "
                                 "at row 0; amplitude^2 = sine^2 + cosine^2"},
                     {.name = "cosine",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.35,
                      .upper = 0.35,
                      .start = 0,
                      .typical = 0.05,
                      .meaning = "the part a quarter of a period ahead of it"}},
      .conditions = {"camera.image-y"},
      .mistaken_for = {{.with = "texture", .told_apart = "lamps on direct current"},
                       {.with = "light.lobe", .told_apart = "lamps on direct current"}},
      .inputs = {{.name = "row", .unit = "px", .lower = 0, .upper = 4000}},
      .act = [](double v, std::span<const double> at,
                std::span<const double> p) { return equation::sensor_row_pattern(v, equation::row_pattern(p), at[0]); },
  };
  return declaration;
}

}  // namespace gonio::mechanism
