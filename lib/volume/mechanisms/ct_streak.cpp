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
          "p' = p - streak m^2 / m_max for the path m of a ray through the listed markers, m_max the longest; grey "
          "value: the filtered back-projection of p' away from the markers",
      .source = "De Man et al., IEEE Transactions on Nuclear Science 46 (1999) 691-696: metal streaks",
      .stage = "tomograph",
      .target = Target::scene,
      .domains = {"volumes"},
      .parameters = {{.name = "streak",
                      .unit = "1",
                      .lower = -5,
                      .upper = 20,
                      .start = 0.1,
                      .meaning = "attenuation that the longest path through markers lacks, as paths through the "
                                 "object over that path"}},
      .conditions = {"volume.marker-path", "volume.path"},
      .mistaken_for = {{.with = "ct.beam-hardening", .told_apart = "take the markers off"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
