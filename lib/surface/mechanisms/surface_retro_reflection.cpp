// surface.retro-reflection: light goes back to where it came from. Equation: surface/retro_lobe.h.
// The lobe has half its height where lamp and eye are 1.3 retro_alpha apart (rad): beads and sheeting stay below 0.1,
// fabric and dust below 0.6, 45 degrees. What is broader sends light everywhere and is a rough matte base by another
// name.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_retro_reflection() {
  static const Mechanism declaration{
      .id = "surface.retro-reflection",
      .sentence = "Part of the light is sent back to the lamp, as fabric, dust, beads and crossed fibres do.",
      .typical = "1 to 30 % of the light",
      .equation =
          "f = (1 - retro) f + retro D G2 / (4 cos_i cos_o) (cos_i cos_o)^(retro_falloff / 2) of the light and the "
          "direction to the eye turned by 180 degrees about the normal, GGX of roughness retro_alpha",
      .source = "after the back vector of Belcour et al. 2025; Walter et al. 2007, equations 33 and 34; EN 12899-1",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"tables", "images", "stacks"},
      .parameters =
          {{.name = "retro",
            .unit = "1",
            .neutral = 0,
            .lower = 0,
            .upper = 0.6,
            .start = 0.1,
            .typical = 0.15,
            .meaning = "share of the light that is sent back"},
           {.name = "retro_alpha",
            .unit = "1",
            .neutral = 0.3,
            .lower = 0.05,
            .upper = 0.6,
            .start = 0.3,
            .typical = 0.15,
            .meaning = "width of the lobe that is sent back, as a GGX roughness; without effect where the share is 0"},
           {.name = "retro_falloff",
            .unit = "1",
            .neutral = 0,
            .lower = 0,
            .upper = 8,
            .start = 1,
            .typical = 3,
            .meaning = "retro-reflection falls with this power of the cosine of incidence; without effect where the "
                       "share is 0"}},
      .conditions = {"surface.phase-angle", "surface.incidence-angle", "surface.exitance-angle"},
      .mistaken_for = {{.with = "surface.diffuse-roughness", .told_apart = "a light beside the camera"},
                       {.with = "light.ambient", .told_apart = "switch the lamp off"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
