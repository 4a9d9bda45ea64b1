// surface.residue: lumps of material on an engineered relief. Equation: surface/residue.h, in every model that has
// these parameters. Traced ridges with burrs are what it stands for (contrast/predict/brute_force.h).
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_residue() {
  static const Mechanism declaration{
      .id = "surface.residue",
      .sentence = "Lumps of material on a micro-structure, such as burrs, flash or dust, cover part of its facets.",
      .typical = "5 to 60 % of the facets",
      .equation =
          "f = (1 - residue_share) f + residue_share (F + (1 - F)^2 rho_d / pi) D G2 / (4 cos_i cos_o), GGX of "
          "roughness residue_alpha about the sample's normal",
      .source = "conjectured in Luongo et al. 2017, section 5; Walter et al. 2007, equations 33 and 34",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"tables"},
      .parameters = {{.name = "residue_share",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.98,
                      .start = 0.2,
                      .typical = 0.3,
                      .meaning = "share of the facets that is covered"},
                     {.name = "residue_alpha",
                      .unit = "1",
                      .neutral = 0.5,
                      .lower = 0.1,
                      .upper = 1,
                      .start = 0.5,
                      .typical = 0.3,
                      .meaning = "roughness of what covers them; without effect where the share is 0"}},
      .conditions = {"surface.half-angle", "surface.incidence-angle", "surface.exitance-angle"},
      .mistaken_for = {{.with = "surface.specular", .told_apart = "turn the sample: residue has no direction"},
                       {.with = "surface.walls",
                        .told_apart = "turn the sample: light of walls comes back across the ridges alone"},
                       {.with = "roughness of the facets",
                        .told_apart = "between the lobes of facets and far from all of them"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
