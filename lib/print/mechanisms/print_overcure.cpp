// print.overcure: light goes through layers.
#include "print/mechanisms/print_overcure.h"

namespace gonio::mechanism {

const Mechanism& print_overcure() {
  static const Mechanism declaration{
      .id = "print.overcure",
      .sentence = "Light of later layers goes through them and cures those before on.",
      .typical = "10 to 100 um depth of penetration",
      .equation =
          "G_k = L_k + exp(-t / overcure_m) G_(k+1): G all the light of a layer, L that of its own picture, t "
          "the thickness of the layer above",
      .source =
          "Jacobs, Rapid Prototyping & Manufacturing, 1992, chapter 4 (print-through); Gong et al., RSC Advances "
          "5 (2015) 106621, equation 2",
      .stage = "print",
      .target = Target::scene,
      .domains = {"prints"},
      .parameters = {{.name = "overcure_m",
                      .unit = "m",
                      .lower = 0,
                      .upper = 1e-3,
                      .start = 1.5e-5,
                      .typical = 3e-5,
                      .meaning = "depth in which light falls to 1/e"}},
      .conditions = {"print.later-light", "print.grey"},
      .mistaken_for = {{.with = "print.growth", .told_apart = "a wedge under later layers beside one without"},
                       {.with = "print.bleed", .told_apart = "wide fields under faint later layers"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
