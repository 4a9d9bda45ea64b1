// light.spectrum: the colour of a lamp changes. It acts on images that state their time.
#include "light/mechanisms/light_spectrum.h"

namespace gonio::mechanism {

const Mechanism& light_spectrum() {
  static const Mechanism declaration{
      .id = "light.spectrum",
      .sentence = "The lamp's spectrum shifts while it runs, so that the channels change against each other.",
      .typical = "1 to 5 nm; some 0.1 to 3 % in ratios of channels",
      .equation =
          "red *= 1 + red_share t / T, blue *= 1 + blue_share t / T; t since the first recording, T to the last",
      .source = "first order in the shift of the peak; LEDs: Chhajed et al. 2005",
      .stage = "light",
      .target = Target::scene,
      .domains = {"tables", "images"},
      .parameters = {{.name = "red_share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.3,
                      .upper = 0.3,
                      .start = 0.01,
                      .typical = 0.01,
                      .meaning = "relative change of red against green over the whole time"},
                     {.name = "blue_share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.3,
                      .upper = 0.3,
                      .start = 0.01,
                      .typical = 0.01,
                      .meaning = "relative change of blue against green over the whole time"}},
      .conditions = {"image.time", "image.channel"},
      .mistaken_for = {{.with = "surface.fluorescence", .told_apart = "a spectrometer on the lamp, or a UV filter"},
                       {.with = "light.drift", .told_apart = "ratios of channels: warming up leaves them"}},
      .inputs = {{.name = "time_s", .unit = "1", .lower = 0, .upper = 1},
                 {.name = "channel", .unit = "1", .lower = 0, .upper = 2}},
      .act =
          [](double v, std::span<const double> at, std::span<const double> p) {
            return at[1] == 0 || at[1] == 2 ? v * equation::light_spectrum(p[at[1] == 0 ? 0 : 1], at[0]) : v;
          },
  };
  return declaration;
}

}  // namespace gonio::mechanism
