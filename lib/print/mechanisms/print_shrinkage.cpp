// print.shrinkage: the print shrinks as it cures on and dries.
#include "print/mechanisms/print_shrinkage.h"

namespace gonio::mechanism {

const Mechanism& print_shrinkage() {
  static const Mechanism declaration{
      .id = "print.shrinkage",
      .sentence = "The print is smaller than what was sent, each axis by a share of its own.",
      .typical = "0.3 to 3 %",
      .equation = "a place p from the map's centre goes to (1 - x, 1 - y) p, heights to (1 - z) h",
      .source = "Karalekas & Aggelopoulos, Journal of Materials Processing Technology 136 (2003) 146-150",
      .stage = "print",
      .target = Target::scene,
      .domains = {"prints"},
      .parameters = {{.name = "x",
                      .unit = "1",
                      .lower = 0,
                      .upper = 0.1,
                      .start = 0.005,
                      .typical = 0.01,
                      .meaning = "share along the rows of pixels"},
                     {.name = "y",
                      .unit = "1",
                      .lower = 0,
                      .upper = 0.1,
                      .start = 0.005,
                      .typical = 0.01,
                      .meaning = "share along the columns of pixels"},
                     {.name = "z",
                      .unit = "1",
                      .lower = 0,
                      .upper = 0.2,
                      .start = 0.005,
                      .typical = 0.01,
                      .meaning = "share away from the platform"}},
      .conditions = {"print.size-x", "print.size-y", "print.height"},
      .mistaken_for = {{.with = "print.growth", .told_apart = "steps of whole layers"},
                       {.with = "print.layer-shift", .told_apart = "patterns on several layers, far from each other"},
                       {.with = "the instrument's scale",
                        .told_apart = "measure a step and a grid that are certified"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
