// surface.interface: varnish, glaze, skin of a plastic. Equation: surface/models/coated_diffuse.cpp.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_interface() {
  static const Mechanism declaration{
      .id = "surface.interface",
      .sentence = "A clear interface lies over the matte base and adds a gloss that leaves the base a little darker.",
      .typical = "F0 of 2 to 8 %, a lobe up to 10 times the diffuse light",
      .equation =
          "f = F(wi.h) D(h) G2 / (4 cos_i cos_o) + f_base (1 - E(wi)) (1 - E(wo)) / (1 - E_mean), GGX of roughness "
          "alpha, "
          "Fresnel factor of the index (1 + sqrt(f0)) / (1 - sqrt(f0))",
      .source = "Walter et al. 2007, equations 20, 33, 34; Kelemen & Szirmay-Kalos 2001",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"images", "tables", "stacks"},
      .parameters = {{.name = "f0",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.1,
                      .start = 0.04,
                      .typical = 0.04,
                      .meaning = "reflectance at normal incidence; clear dielectrics have 0.02 to 0.08"},
                     {.name = "alpha",
                      .unit = "1",
                      .neutral = 0.2,
                      .lower = 0.02,
                      .upper = 0.6,
                      .start = 0.2,
                      .typical = 0.15,
                      .meaning = "GGX roughness; without effect where f0 is 0"}},
      .conditions = {"surface.half-angle", "surface.exitance-angle", "surface.incidence-angle", "image.radiance"},
      .mistaken_for = {{.with = "surface.metal",
                        .told_apart = "crossed polarizers: the gloss of a dielectric goes dark"},
                       {.with = "surface.specular", .told_apart = "a finer scan around the mirror direction"},
                       {.with = "light.second-source", .told_apart = "cover the second source"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
