// mask.caustic: light that an object lets through falls into its shadow. Test: explain/outlines/caustics.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& mask_caustic() {
  static const Mechanism declaration{
      .id = "mask.caustic",
      .sentence = "Parts of the shadow are lit: the object gathers light there, and masks take them for lit ground.",
      .typical = "5 to 50 % of a glass object's shadow",
      .equation = "shadow' = shadow - lit: rims that no rim of the model lies beside, inside of the model's shadow",
      .source = "masks of glass corrected by hand: Hannemose et al. 2020, section 4",
      .stage = "transport",
      .target = Target::light,
      .domains = {"outlines"},
      .parameters = {{.name = "share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1,
                      .start = 0.1,
                      .typical = 0.1,
                      .meaning = "of the shadow's seen rims that runs around lit parts of it"}},
      .conditions = {"shadow.depth"},
      .mistaken_for = {{.with = "transport.indirect", .told_apart = "a black cover over the object"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
