// surface.walls: light by way of the walls between ridges. Equation: surface/ridge_walls.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_walls() {
  static const Mechanism declaration{
      .id = "surface.walls",
      .sentence = "The steep walls between ridges reflect as well, by themselves and with a facet, back to the lamp.",
      .typical = "as much as facets would, 1, where walls are as smooth; 0 where they are torn",
      .equation =
          "f = f_facets + walls (f_walls + f_facet_and_wall), the saw of walls leaning by 90 degrees - ridge_rad the "
          "other way, and one reflection at each flank",
      .source = "masking of Luongo et al. 2017, equation 2, for either flank; surface/ridge_walls.h",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"tables"},
      .parameters = {{.name = "walls",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1,
                      .start = 0.5,
                      .typical = 1,
                      .meaning = "what the walls reflect, as a share of what facets would"}},
      .conditions = {"surface.azimuth", "surface.half-angle", "surface.exitance-angle"},
      .mistaken_for = {{.with = "surface.residue",
                        .told_apart = "turn the sample: residue reflects the same in every azimuth"},
                       {.with = "surface.retro-reflection", .told_apart = "turn the sample by 90 degrees"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
