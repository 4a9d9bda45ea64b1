// ct.ring: a pixel that always reads wrong.
#include "volume/mechanisms/ct_ring.h"

namespace gonio::mechanism {

const Mechanism& ct_ring() {
  static const Mechanism declaration{
      .id = "ct.ring",
      .sentence =
          "Pixels of the detector whose gain is off draw rings round the rotation axis: the same error at a radius of "
          "a "
          "slice, whatever the angle.",
      .typical = "0.2 to 3 % of the material's value",
      .equation =
          "v' = v + ring c(r, z): c, of root mean square one, is the fine structure in the radius r of slice z that "
          "the "
          "sectors away from the place show",
      .source = "Sijbers & Postnov, Physics in Medicine and Biology 49 (2004) N247-N253",
      .stage = "tomograph",
      .target = Target::scene,
      .domains = {"volumes"},
      .parameters = {{.name = "ring",
                      .unit = "1",
                      .lower = 0,
                      .upper = 2,
                      .start = 0.01,
                      .typical = 0.01,
                      .meaning = "root mean square of the rings, as a share of material less air"}},
      .conditions = {"volume.ring", "volume.radius"},
      .mistaken_for = {{.with = "noise", .told_apart = "scan twice: rings come back, noise does not"},
                       {.with = "ct.cupping", .told_apart = "move the detector sideways between the views"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
