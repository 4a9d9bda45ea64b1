// surface.roughness: a surface is rougher than was believed, all over. Slopes of independent roughnesses add, and alpha
// goes with their root mean square. In scenes it is the surface's own parameter alpha, which explain writes.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_roughness() {
  static const Mechanism declaration{
      .id = "surface.roughness",
      .sentence = "The surface is rougher than was believed: what it mirrors and what is seen through it is blurred.",
      .typical = "alpha 0.05 to 0.3",
      .equation = "alpha' = sqrt(alpha^2 + more^2)",
      .source = "Walter et al. 2007, section 5.2 (alpha and slopes)",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"traced", "polarization"},
      .parameters = {{.name = "more",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1,
                      .start = 0.1,
                      .typical = 0.1,
                      .meaning = "alpha of a smooth surface that is as rough as what was left out"}},
      .conditions = {"surface.incidence-angle"},
      .mistaken_for = {{.with = "light.finite-size", .told_apart = "a smaller lamp"},
                       {.with = "optics.defocus", .told_apart = "edges of what is seen directly"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
