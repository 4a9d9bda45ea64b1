// polarizer.leak: finite extinction.
#include "photograph/mechanisms/polarizer_leak.h"

namespace gonio::mechanism {

const Mechanism& polarizer_leak() {
  static const Mechanism declaration{
      .id = "polarizer.leak",
      .sentence = "Polarizers let through a share of the light that they should absorb.",
      .typical = "1/300 in the middle of the visible, 1/20 towards its ends",
      .equation =
          "reading = (1 + leak) s0 / 2 + (1 - leak) (s1 cos 2a + s2 sin 2a) / 2, leak one over the extinction "
          "ratio: degrees of polarization fall by (1 - leak) / (1 + leak)",
      .source = "Collett 2005, equation 5-15 (p_y^2 / p_x^2 = leak); Sony IMX250MZR data sheet (extinction ratios)",
      .stage = "sensor",
      .target = Target::camera,
      .domains = {"polarization", "tables"},
      .parameters = {{.name = "leak",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.5,
                      .start = 0.02,
                      .typical = 0.03,
                      .meaning = "transmittance across the axis over that along it"}},
      .conditions = {"light.polarized-part", "polarimeter.analyser"},
      .mistaken_for = {{.with = "screen.leak",
                        .told_apart = "light that a surface has polarized, or a sheet polarizer"},
                       {.with = "sensor.crosstalk", .told_apart = "an edge between dark and bright"},
                       {.with = "surface.roughness", .told_apart = "look at the screen itself"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
