// surface.print-layers: every second layer of a print is rougher. The law is print-layers
// (surface/laws/print_layers.cpp) with alpha_even = alpha; explain writes it into the surface's "laws".
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_print_layers() {
  static const Mechanism declaration{
      .id = "surface.print-layers",
      .sentence = "Layers of a print are rough and smooth by turns.",
      .typical = "0.1 to 0.3 in alpha, layers of 0.02 to 5 mm",
      .equation = "alpha' = alpha + rougher where floor((z - layer_offset_m) / layer_m) is odd",
      .source = "law print-layers; Hannemose et al. 2020, section 5",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"traced"},
      .parameters = {{.name = "rougher",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -1,
                      .upper = 1,
                      .start = 0.1,
                      .typical = 0.2,
                      .meaning = "alpha of odd layers less that of even ones"},
                     {.name = "layer_m",
                      .unit = "m",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1,
                      .start = 0.002,
                      .typical = 0,
                      .meaning = "thickness of a layer"},
                     {.name = "layer_offset_m",
                      .unit = "m",
                      .neutral = 0,
                      .lower = -1,
                      .upper = 1,
                      .start = 0,
                      .typical = 0,
                      .meaning = "height of the lower boundary of an even layer"}},
      .conditions = {"object.height"},
      .mistaken_for = {{.with = "surface.print-slopes", .told_apart = "a closer look at one slope"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
