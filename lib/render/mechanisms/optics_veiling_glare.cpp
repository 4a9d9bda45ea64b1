// optics.veiling-glare: light strays inside the lens.
#include "render/mechanisms/optics_veiling_glare.h"

namespace gonio::mechanism {

const Mechanism& optics_veiling_glare() {
  static const Mechanism declaration{
      .id = "optics.veiling-glare",
      .sentence = "Light strays between lens and sensor and lies over the whole picture as a veil.",
      .typical = "0.5 to 5 % of the mean radiance",
      .equation = "v += share mean(v), the mean over the picture, channel by channel",
      .source = "ISO 9358:1994, veiling glare index; Talvala et al. 2007 (uniform part)",
      .stage = "optics",
      .target = Target::camera,
      .domains = {"stacks", "images", "polarization"},
      .parameters = {{.name = "share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.2,
                      .start = 0.02,
                      .typical = 0.02,
                      .meaning = "share of the picture's mean that is added to every pixel"}},
      .conditions = {"image.mean", "image.radiance"},
      .mistaken_for = {{.with = "light.ambient", .told_apart = "mask the bright areas"},
                       {.with = "sensor.black-offset", .told_apart = "mask the bright areas: an offset stays"}},
      .inputs = {{.name = "mean_of_picture", .unit = "W/(m^2 sr)", .lower = 0, .upper = 10}},
      .act = [](double v, std::span<const double> at,
                std::span<const double> p) { return equation::optics_veiling_glare(v, p[0], at[0]); },
  };
  return declaration;
}

}  // namespace gonio::mechanism
