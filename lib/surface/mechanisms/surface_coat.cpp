// surface.coat: varnish on a part of an object. Equations: surface/coat_region.h, surface/models/coated_diffuse.cpp.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_coat() {
  static const Mechanism declaration{
      .id = "surface.coat",
      .sentence = "A part of the object has a clear coat: glazed to a line, dipped, wet, varnished on one side.",
      .typical = "the gloss of an interface on a third of the object",
      .equation =
          "f = (1 - cover) f + cover f_coated, f_coated that of surface.interface with f0 and alpha, cover = 1 / (1 + "
          "exp(-(d.x - from_m) / edge_m)), d the direction of azimuth_rad and elevation_rad, x in the object's frame",
      .source = "as surface.interface; the region is a half space with a soft edge",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"images"},
      .parameters =
          {{.name = "f0",
            .unit = "1",
            .neutral = 0,
            .lower = 0,
            .upper = 0.1,
            .start = 0.04,
            .typical = 0.04,
            .meaning = "reflectance of the coat at normal incidence"},
           {.name = "alpha",
            .unit = "1",
            .neutral = 0.2,
            .lower = 0.02,
            .upper = 0.6,
            .start = 0.2,
            .typical = 0.15,
            .meaning = "GGX roughness of the coat; without effect where f0 is 0"},
           {.name = "azimuth_rad",
            .unit = "rad",
            .neutral = 0,
            .lower = -6.3,
            .upper = 6.3,
            .start = 0,
            .meaning = "azimuth of the direction from the bare part to the coated one; without effect where f0 is 0"},
           {.name = "elevation_rad",
            .unit = "rad",
            .neutral = 0,
            .lower = -1.6,
            .upper = 1.6,
            .start = 0,
            .meaning = "its elevation above the object's xy plane; without effect where f0 is 0"},
           {.name = "from_m",
            .unit = "m",
            .neutral = 0,
            .lower = -10,
            .upper = 10,
            .start = 0,
            .meaning = "where the coat begins along that direction; without effect where f0 is 0"},
           {.name = "edge_m",
            .unit = "m",
            .neutral = 0.001,
            .lower = 0.00001,
            .upper = 1,
            .start = 0.001,
            .meaning = "softness of its edge; without effect where f0 is 0"}},
      .conditions = {"surface.half-angle", "scene.x", "scene.y", "scene.z"},
      .mistaken_for = {{.with = "surface.interface", .told_apart = "turn the object: the gloss stays on its part"},
                       {.with = "surface.spatial-variation",
                        .told_apart = "move the light: a stain stays, a gloss goes"},
                       {.with = "light.lobe", .told_apart = "turn the object"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
