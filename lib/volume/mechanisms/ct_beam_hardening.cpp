// ct.beam-hardening: soft X-rays are absorbed first.
#include "volume/mechanisms/ct_beam_hardening.h"

namespace gonio::mechanism {

const Mechanism& ct_beam_hardening() {
  static const Mechanism declaration{
      .id = "ct.beam-hardening",
      .sentence =
          "Soft X-rays are absorbed first, so that long paths attenuate less than their length says: material darkens "
          "inside, air darkens or lightens between thick parts.",
      .typical = "5 to 30 % at the longest path",
      .equation =
          "p' = p - hardening p_max (p - q(p)) / (p_max - q(p_max)), q = ln(1 + v p) / v, v = 0.8, for the line "
          "integral "
          "p of the believed shape in attenuation lengths, p_max its longest; readings: those of the filtered "
          "back-projection of p'",
      .source =
          "Brooks & Di Chiro, Physics in Medicine and Biology 21 (1976) 390-398; Herman, same journal 24 (1979) "
          "81-106: the polychromatic line integral; here attenuations over the spectrum are gamma-distributed",
      .stage = "tomograph",
      .target = Target::scene,
      .domains = {"volumes"},
      .parameters = {{.name = "hardening",
                      .unit = "1",
                      .lower = -0.2,
                      .upper = 0.9,
                      .start = 0.1,
                      .typical = 0.15,
                      .meaning = "share by which the longest path through the object reads too little"}},
      .conditions = {"volume.path", "volume.depth", "volume.radius"},
      .mistaken_for = {{.with = "ct.cupping", .told_apart = "look at the air in hollows: only hardening reaches it"},
                       {.with = "ct.scatter", .told_apart = "filter the beam with copper; close the collimator"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
