// screen.leak: finite extinction of a screen's own polarizer.
#include "light/mechanisms/screen_leak.h"

namespace gonio::mechanism {

const Mechanism& screen_leak() {
  static const Mechanism declaration{
      .id = "screen.leak",
      .sentence = "A screen's light is less polarized than was believed.",
      .typical = "0.1 to 3 % on the axis of a liquid crystal display, ten times that under a scattering coat",
      .equation = "polarization_degree' = polarization_degree (1 - leak) / (1 + leak); radiance stays",
      .source = "Collett 2005, equation 5-15; Fainman & Shamir 1984 (sheet polarizers)",
      .stage = "light",
      .target = Target::light,
      .domains = {"polarization"},
      .parameters = {{.name = "leak",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.9,
                      .start = 0.02,
                      .typical = 0.03,
                      .meaning = "light across the stated direction over that along it"}},
      .conditions = {"screen.polarized-part"},
      .mistaken_for = {{.with = "polarizer.leak", .told_apart = "light that a surface has polarized"},
                       {.with = "surface.roughness", .told_apart = "look at the screen itself"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
