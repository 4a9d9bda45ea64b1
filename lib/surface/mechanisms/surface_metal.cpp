// surface.metal: what is believed matte is bare metal. Equation: surface/models/compound.cpp.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_metal() {
  static const Mechanism declaration{
      .id = "surface.metal",
      .sentence = "The surface is metal, or part of it is: its colour is in the gloss, and no matte base lies beneath.",
      .typical = "all of the light of a metal; 5 to 50 % of a metallic paint",
      .equation =
          "f = (1 - metal) f + metal F(wi.h) D(h) G2 / (4 cos_i cos_o) and what meets several facets, GGX of roughness "
          "metal_alpha, F = albedo + (1 - albedo) (1 - wi.h)^5",
      .source = "Walter et al. 2007, equations 20, 33, 34; Schlick 1994, equation 15; Kulla & Conty 2017",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"images", "tables", "stacks"},
      .parameters = {{.name = "metal",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1,
                      .start = 0.5,
                      .typical = 0.5,
                      .meaning = "share of the area that is bare metal"},
                     {.name = "metal_alpha",
                      .unit = "1",
                      .neutral = 0.3,
                      .lower = 0.02,
                      .upper = 1,
                      .start = 0.3,
                      .typical = 0.2,
                      .meaning = "GGX roughness of the metal; without effect where its share is 0"}},
      .conditions = {"surface.half-angle", "surface.incidence-angle", "surface.exitance-angle"},
      .mistaken_for = {{.with = "surface.interface",
                        .told_apart = "crossed polarizers: the gloss of a dielectric goes dark"},
                       {.with = "surface.specular", .told_apart = "a finer scan around the mirror direction"},
                       {.with = "light.lobe", .told_apart = "rotate the light alone"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
