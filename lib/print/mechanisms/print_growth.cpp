// print.growth: voxels do not grow as the manifest says.
#include "print/mechanisms/print_growth.h"

namespace gonio::mechanism {

const Mechanism& print_growth() {
  static const Mechanism declaration{
      .id = "print.growth",
      .sentence =
          "Voxels grow by another law of their grey value than is stated: with the logarithm of the light above a "
          "threshold, or with other numbers.",
      .typical = "thresholds of 0.1 to 0.3; lamps that have aged by 10 to 30 %",
      .equation =
          "h(I) = alpha + beta log(I - gamma) = H log(1 + k (I - I0)) / log(1 + k (1 - I0)), where H is (1 + white) "
          "times, I0 threshold and k curvature more than what is stated; in proportion to the grey value: k = 0, I0 = "
          "0",
      .source = "Jacobs, Rapid Prototyping & Manufacturing, 1992, chapter 4; Luongo et al. 2020, equation 1",
      .stage = "print",
      .target = Target::scene,
      .domains = {"prints"},
      .parameters = {{.name = "white",
                      .unit = "1",
                      .lower = -0.7,
                      .upper = 2,
                      .start = 0.1,
                      .typical = 0.2,
                      .meaning = "share by which white would grow higher, were it not for the membrane"},
                     {.name = "threshold",
                      .unit = "1",
                      .lower = -0.5,
                      .upper = 0.7,
                      .start = 0.05,
                      .typical = 0.1,
                      .meaning = "grey by which the darkest grey that cures is brighter"},
                     {.name = "curvature",
                      .unit = "1",
                      .lower = -20,
                      .upper = 60,
                      .start = 1,
                      .typical = 3,
                      .meaning = "by which the law's curvature is larger, one over grey"}},
      .conditions = {"print.grey", "print.below-top"},
      .mistaken_for = {{.with = "print.bleed", .told_apart = "print wide fields of each grey, far from others"},
                       {.with = "print.membrane", .told_apart = "print a wedge that stays below white"},
                       {.with = "print.overcure", .told_apart = "print the wedge as the last layer"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
