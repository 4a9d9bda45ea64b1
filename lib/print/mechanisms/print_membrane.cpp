// print.membrane: the membrane leaves less room than a layer.
#include "print/mechanisms/print_membrane.h"

namespace gonio::mechanism {

const Mechanism& print_membrane() {
  static const Mechanism declaration{
      .id = "print.membrane",
      .sentence = "The membrane leaves less room than a layer is thick: tops are flattened below their layer's top.",
      .typical = "1 to 5 um",
      .equation = "top = min(top, layer's top - cut_m)",
      .source = "Luongo et al. 2020, section 5: heights clamped at the membrane",
      .stage = "print",
      .target = Target::scene,
      .domains = {"prints"},
      .parameters = {{.name = "cut_m",
                      .unit = "m",
                      .lower = 0,
                      .upper = 1e-3,
                      .start = 2e-6,
                      .typical = 2e-6,
                      .meaning = "how far below the layer's top"}},
      .conditions = {"print.below-top", "print.grey"},
      .mistaken_for = {{.with = "print.growth", .told_apart = "a wedge: the darker greys keep their heights"},
                       {.with = "print.shrinkage", .told_apart = "a wedge: the darker greys keep their heights"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
