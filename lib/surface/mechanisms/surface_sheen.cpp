// surface.sheen: fibres that shine at grazing angles. Equations: surface/sheen.h. What sends light back to the lamp
// from everywhere (beads, dust) is surface.retro-reflection.
#include "mechanism/form.h"

namespace gonio::mechanism {

const Mechanism& surface_sheen() {
  static const Mechanism declaration{
      .id = "surface.sheen",
      .sentence = "Fibres stand on the surface and shine at grazing angles: velvet, cloth, peach skin, dust.",
      .typical = "5 to 50 % of the light near the limb",
      .equation =
          "f = (1 - sheen - sheen_forward) f + sheen D G / (4 cos_i cos_o) + sheen_forward pi (1 - wi.h)^5, D = "
          "exp(-cot^2(h) / w^2) / (pi w^2 sin^4(h)), G = min(1, 2 h_z min(cos_i, cos_o) / wi.h), w = sheen_width",
      .source = "after Ashikhmin, Distribution-based BRDFs, 2007; Burley 2012, section 5.5",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"images", "tables", "stacks"},
      .parameters = {{.name = "sheen",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.9,
                      .start = 0.1,
                      .typical = 0.15,
                      .meaning = "share of fibres that stand on the surface"},
                     {.name = "sheen_width",
                      .unit = "1",
                      .neutral = 0.5,
                      .lower = 0.1,
                      .upper = 1.5,
                      .start = 0.5,
                      .typical = 0.3,
                      .meaning =
                          "spread of their normals about the horizon, as a slope; without effect where sheen is 0"},
                     {.name = "sheen_forward",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.6,
                      .start = 0.1,
                      .typical = 0.15,
                      .meaning = "share of the sheen of light that faces the eye across the surface"}},
      .conditions = {"surface.exitance-angle", "surface.incidence-angle", "surface.half-angle", "surface.phase-angle"},
      .mistaken_for = {{.with = "surface.diffuse-roughness", .told_apart = "a light opposite to the camera"},
                       {.with = "surface.interface", .told_apart = "crossed polarizers: a gloss goes dark"},
                       {.with = "surface.retro-reflection", .told_apart = "a light beside the camera"}},
  };
  static const Forms forms(
      declaration, {{.sentence = "fibres that stand up", .held = {{"sheen_forward", 0}}},
                    {.sentence = "light that grazes them forwards", .held = {{"sheen", 0}, {"sheen_width", 0.5}}}});
  return declaration;
}

}  // namespace gonio::mechanism
