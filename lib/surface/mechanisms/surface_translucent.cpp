// surface.translucent: light comes through. Equation: surface/models/sheet.cpp.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_translucent() {
  static const Mechanism declaration{
      .id = "surface.translucent",
      .sentence = "The surface is a thin sheet that lets part of the light through: paper, a leaf, cloth, a shade.",
      .typical = "10 to 50 % of what is not absorbed",
      .equation =
          "f = (1 - translucent) f on the side of the lamp, translucent albedo / pi on the other side, of either side",
      .source = "Lambert's law for what goes through",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"images"},
      .parameters = {{.name = "translucent",
                      .unit = "1",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.95,
                      .start = 0.2,
                      .typical = 0.3,
                      .meaning = "share of what is not absorbed that goes through"}},
      .conditions = {"surface.incidence-angle", "scene.x", "scene.y", "scene.z"},
      .mistaken_for = {{.with = "light.ambient", .told_apart = "cover the far side"},
                       {.with = "light.second-source", .told_apart = "cover the far side"},
                       {.with = "surface.subsurface", .told_apart = "a spot of light: a sheet does not spread it"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
