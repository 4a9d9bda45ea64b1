// surface.specular: one lobe is not enough. Equation: surface/gloss_lobes.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_specular() {
  static const Mechanism declaration{
      .id = "surface.specular",
      .sentence = "The gloss has a second lobe: a broad tail under a narrow peak, or haze about it.",
      .typical = "a factor 2 to 10 away from the peak",
      .equation =
          "lobe = (1 - second_share) GGX(alpha) + second_share GGX(second_alpha), both under the same Fresnel factor",
      .source = "Cook & Torrance 1982, equation 13; Walter et al. 2007, equation 33",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"tables", "images"},
      .parameters = {{.name = "second_share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.98,
                      .start = 0.3,
                      .typical = 0.3,
                      .meaning = "share of the facets that have the second roughness"},
                     {.name = "second_alpha",
                      .unit = "1",
                      .neutral = 0.4,
                      .lower = 0.02,
                      .upper = 1,
                      .start = 0.4,
                      .typical = 0.3,
                      .meaning = "GGX roughness of the second lobe; without effect where the share is 0"}},
      .conditions = {"surface.half-angle", "surface.exitance-angle", "surface.incidence-angle",
                     "surface.difference-angle"},
      .mistaken_for = {{.with = "surface.interface", .told_apart = "a finer scan across the peak"},
                       {.with = "surface.diffuse-roughness",
                        .told_apart = "crossed polarizers: the tail goes dark, the matte base does not"},
                       {.with = "light.finite-size", .told_apart = "a smaller lamp"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
