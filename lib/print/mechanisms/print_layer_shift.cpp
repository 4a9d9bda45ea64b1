// print.layer-shift: the platform or the projector slipped.
#include "print/mechanisms/print_layer_shift.h"

namespace gonio::mechanism {

const Mechanism& print_layer_shift() {
  static const Mechanism declaration{
      .id = "print.layer-shift",
      .sentence = "From one layer on all layers are displaced: the platform or the projector slipped.",
      .typical = "0.2 to 2 pixels",
      .equation = "I_k(x, y) becomes I_k(x - x_m, y - y_m) for all layers k from `layer` on",
      .source = "plain geometry: what slips once stays displaced",
      .stage = "print",
      .target = Target::scene,
      .domains = {"prints"},
      .parameters = {{.name = "x_m",
                      .unit = "m",
                      .lower = -1e-3,
                      .upper = 1e-3,
                      .start = 1e-5,
                      .typical = 2e-5,
                      .meaning = "displacement along the rows of pixels"},
                     {.name = "y_m",
                      .unit = "m",
                      .lower = -1e-3,
                      .upper = 1e-3,
                      .start = 1e-5,
                      .typical = 2e-5,
                      .meaning = "displacement along the columns of pixels"},
                     {.name = "layer",
                      .unit = "1",
                      .lower = 0,
                      .upper = 1e6,
                      .start = 2,
                      .meaning = "the first that is displaced, counted from 1 on the platform"}},
      .conditions = {"print.slope-x", "print.slope-y", "print.layer"},
      .mistaken_for = {{.with = "print.shrinkage", .told_apart = "patterns on several layers, far from each other"},
                       {.with = "print.bleed", .told_apart = "edges that face both ways"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
