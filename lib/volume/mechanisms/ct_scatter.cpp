// ct.scatter: photons that changed their way. Equation: explain/volumes/terms/ct_scatter.cpp.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& ct_scatter() {
  static const Mechanism declaration{
      .id = "ct.scatter",
      .sentence =
          "Scattered photons reach the detector everywhere: thick parts look thinner than they are, and hollows fill.",
      .typical = "1 to 20 % of the open beam",
      .equation =
          "p' = p - scatter (exp(p) - 1) for the line integral p of the believed shape, to first order in the scatter; "
          "grey value: the filtered back-projection of p'",
      .source = "Glover, Medical Physics 9 (1982) 860-867; Siewerdsen & Jaffray, same journal 28 (2001) 220-231",
      .stage = "tomograph",
      .target = Target::scene,
      .domains = {"volumes"},
      .parameters = {{.name = "scatter",
                      .unit = "1",
                      .lower = 0,
                      .upper = 0.5,
                      .start = 0.02,
                      .meaning = "scattered photons over those of the open beam"}},
      .conditions = {"volume.path", "volume.depth", "volume.radius"},
      .mistaken_for = {{.with = "ct.beam-hardening",
                        .told_apart = "close the collimator, or filter the beam with copper"},
                       {.with = "ct.cupping", .told_apart = "look at the air in hollows"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
