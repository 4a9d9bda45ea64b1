// surface.diffuse-roughness: matte surfaces are rough. Equation: surface/oren_nayar.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_diffuse_roughness() {
  static const Mechanism declaration{
      .id = "surface.diffuse-roughness",
      .sentence = "The matte surface is rough: it sends more light back towards the lamp and stays bright at its limb.",
      .typical = "5 to 20 % at grazing angles",
      .equation =
          "f = albedo / pi (A + B max(0, cos(phi_i - phi_o)) sin(max theta) tan(min theta)), "
          "A = 1 - 0.5 s / (s + 0.33), B = 0.45 s / (s + 0.09), s = sigma_rad^2",
      .source = "Oren & Nayar 1994, equation 30",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"images", "tables", "stacks"},
      .parameters = {{.name = "sigma_rad",
                      .unit = "rad",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.9,
                      .start = 0.2,
                      .meaning = "standard deviation of the facets' slope angle"}},
      .conditions = {"surface.incidence-angle", "surface.exitance-angle", "surface.phase-angle", "surface.half-angle"},
      .mistaken_for = {{.with = "light.direction", .told_apart = "more lights around the same object"},
                       {.with = "surface.retro-reflection", .told_apart = "a light beside the camera"},
                       {.with = "light.ambient", .told_apart = "switch the lamp off"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
