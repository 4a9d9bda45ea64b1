// surface.diffuse-roughness: matte surfaces are rough. Equations: surface/matte.h.
#include "mechanism/form.h"

namespace gonio::mechanism {

const Mechanism& surface_diffuse_roughness() {
  static const Mechanism declaration{
      .id = "surface.diffuse-roughness",
      .sentence = "The matte surface is rough: it sends more light back towards the lamp and stays bright at its limb.",
      .typical = "5 to 20 % at grazing angles",
      .equation =
          "f = albedo / pi (A + B max(0, cos(phi_i - phi_o)) sin(max theta) tan(min theta)), "
          "A = 1 - 0.5 s / (s + 0.33), B = 0.45 s / (s + 0.09), s = sigma_rad^2 (matte_form 0; 1: with the third term "
          "and light between grooves; 2: f = albedo / pi (1 + sigma_rad t) / (1 + 0.288 sigma_rad), q = wi.wo - wi_z "
          "wo_z, t = q > 0 ? q / max(wi_z, wo_z) : q)",
      .source = "Oren & Nayar 1994, equation 30; 27 and 28; Fujii 2012",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"images", "tables", "stacks"},
      .parameters = {{.name = "sigma_rad",
                      .unit = "rad",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.9,
                      .start = 0.2,
                      .typical = 0.3,
                      .meaning = "standard deviation of the facets' slope angle; of form 2 its roughness"},
                     {.name = "matte_form",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 2,
                      .start = 0,
                      .meaning = "which of the laws; without effect where sigma_rad is 0"}},
      .conditions = {"surface.incidence-angle", "surface.exitance-angle", "surface.phase-angle", "surface.half-angle"},
      .mistaken_for = {{.with = "light.direction", .told_apart = "more lights around the same object"},
                       {.with = "surface.retro-reflection", .told_apart = "a light beside the camera"},
                       {.with = "light.ambient", .told_apart = "switch the lamp off"}},
  };
  static const Forms forms(
      declaration,
      {{.sentence = "by Oren & Nayar's qualitative law", .held = {{"matte_form", 0}}},
       {.sentence = "by their full law, with light between grooves", .held = {{"matte_form", 1}}, .finer = true},
       {.sentence = "by Fujii's law", .held = {{"matte_form", 2}}, .finer = true}});
  return declaration;
}

}  // namespace gonio::mechanism
