// probe.reflectance: a ball of another metal, or a tarnished one.
#include "probe/mechanisms/probe_reflectance.h"

namespace gonio::mechanism {

const Mechanism& probe_reflectance() {
  static const Mechanism declaration{
      .id = "probe.reflectance",
      .sentence =
          "The mirror ball reflects otherwise than the metal that it was taken for: it is another metal, tarnished or "
          "lacquered.",
      .typical =
          "0.02 to 0.4 at normal incidence: silver 0.97, aluminium 0.91, steel 0.6, chromium 0.55; nothing at "
          "grazing incidence, where all metals reflect all light",
      .equation =
          "R' = R + normal (1 - (1 - c)^5) - dip c (1 - c)^6 / 0.05665, c the cosine of incidence and R Fresnel's "
          "reflectance of the stated metal",
      .source = "Schlick 1994, equation 15; Lazanyi & Szirmay-Kalos, WSCG short papers 2005, equation 6",
      .stage = "surface",
      .target = Target::scene,
      .domains = {"tables"},
      .parameters = {{.name = "normal",
                      .unit = "1",
                      .lower = -0.9,
                      .upper = 0.9,
                      .start = 0.05,
                      .typical = 0.2,
                      .meaning = "by which the ball reflects more at normal incidence than stated"},
                     {.name = "dip",
                      .unit = "1",
                      .lower = -0.3,
                      .upper = 0.3,
                      .start = 0.01,
                      .typical = 0.05,
                      .meaning = "by which it reflects less at 82 degrees than Schlick's rise has it"}},
      .conditions = {"surface.incidence-angle"},
      .mistaken_for = {{.with = "sensor.non-linearity",
                        .told_apart = "the same picture at half the exposure: a metal does not ask how bright it is"},
                       {.with = "light.drift", .told_apart = "photograph the first view once more at the end"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
