// ct.scatter: photons that changed their way.
#include "volume/mechanisms/ct_scatter.h"

namespace gonio::mechanism {

const Mechanism& ct_scatter() {
  static const Mechanism declaration{
      .id = "ct.scatter",
      .sentence =
          "Scattered photons reach the detector everywhere: thick parts look thinner than they are, and hollows fill.",
      .typical = "5 to 50 % of what the primary beam lost",
      .equation =
          "p' = L(T + scatter G * (T ln(1/T))) for the line integrals p of the believed shape in attenuation lengths: "
          "T = (1 + v p)^(-1/v) the intensity, L its inverse, v = 0.8, G a Gaussian over the detector, an eighth of "
          "the "
          "field wide; readings: those of the filtered back-projection of p'",
      .source =
          "Ohnesorge, Flohr & Klingenbeck-Regn, European Radiology 9 (1999) 563-569, equation 3: what the primary beam "
          "lost is scattered once and spread",
      .stage = "tomograph",
      .target = Target::scene,
      .domains = {"volumes"},
      .parameters = {{.name = "scatter",
                      .unit = "1",
                      .lower = 0,
                      .upper = 1,
                      .start = 0.02,
                      .typical = 0.2,
                      .meaning = "scattered photons that arrive, over those that the primary beam lost"}},
      .conditions = {"volume.path", "volume.depth", "volume.radius"},
      .mistaken_for = {{.with = "ct.beam-hardening",
                        .told_apart = "close the collimator, or filter the beam with copper"},
                       {.with = "ct.cupping", .told_apart = "look at the air in hollows"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
