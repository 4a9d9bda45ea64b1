// ct.streak: bright and dark bands between dense parts.
#include "volume/mechanisms/ct_streak.h"

namespace gonio::mechanism {

const Mechanism& ct_streak() {
  static const Mechanism declaration{
      .id = "ct.streak",
      .sentence =
          "Rays through dense markers read too little: dark bands run between the markers, bright ones beside them.",
      .typical = "5 to 50 % of the material's value near dense markers",
      .equation =
          "p' = p - streak (p^2 - q^2) - ln((1 + floor / T) / (1 + floor / U)) for the line integrals p with and q "
          "without the listed markers, T = exp(-p), U = exp(-q); grey value: the filtered back-projection of p' away "
          "from the markers",
      .source = "De Man et al., IEEE Transactions on Nuclear Science 46 (1999) 691-696: metal streaks",
      .stage = "tomograph",
      .target = Target::scene,
      .domains = {"volumes"},
      .parameters = {{.name = "streak",
                      .unit = "1",
                      .lower = -0.5,
                      .upper = 0.5,
                      .start = 0.02,
                      .typical = 0.2,
                      .meaning = "hardening behind markers: what a line integral lacks over its square, beyond what it "
                                 "lacks without markers"},
                     {.name = "floor",
                      .unit = "1",
                      .lower = 0,
                      .upper = 0.5,
                      .start = 0.01,
                      .typical = 0.02,
                      .meaning = "transmission that the detector reads too much behind markers: what it cannot tell "
                                 "from darkness, or what is scattered there"}},
      .conditions = {"volume.marker-path", "volume.path"},
      .mistaken_for = {{.with = "ct.beam-hardening", .told_apart = "take the markers off"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
