// surface.spatial-variation: a stain. Equation: surface/stain.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& surface_spatial_variation() {
  static const Mechanism declaration{
      .id = "surface.spatial-variation",
      .sentence = "A place on the object is darker or lighter than the rest of it: a stain, a worn spot.",
      .typical = "any size; 5 to 50 % of the albedo",
      .equation = "albedo *= 1 + depth exp(-|x - (x_m, y_m, z_m)|^2 / (2 width_m^2)), x in the object's frame",
      .source = "first moment of a smooth spot",
      .stage = "surface",
      .target = Target::surface,
      .domains = {"images"},
      .parameters = {{.name = "x_m",
                      .unit = "m",
                      .neutral = 0,
                      .lower = -10,
                      .upper = 10,
                      .start = 0,
                      .meaning = "x of its middle in the object's frame; without effect where depth is 0"},
                     {.name = "y_m",
                      .unit = "m",
                      .neutral = 0,
                      .lower = -10,
                      .upper = 10,
                      .start = 0,
                      .meaning = "y of its middle in the object's frame; without effect where depth is 0"},
                     {.name = "z_m",
                      .unit = "m",
                      .neutral = 0,
                      .lower = -10,
                      .upper = 10,
                      .start = 0,
                      .meaning = "z of its middle in the object's frame; without effect where depth is 0"},
                     {.name = "width_m",
                      .unit = "m",
                      .neutral = 0.01,
                      .lower = 0.0001,
                      .upper = 1,
                      .start = 0.01,
                      .typical = 0.01,
                      .meaning = "standard deviation of its extent; without effect where depth is 0"},
                     {.name = "depth",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.9,
                      .upper = 2,
                      .start = -0.2,
                      .typical = 0.3,
                      .meaning = "relative change of the albedo in its middle"}},
      .conditions = {"scene.x", "scene.y", "scene.z"},
      .mistaken_for = {{.with = "light.finite-size", .told_apart = "move the light: a stain stays"},
                       {.with = "transport.indirect", .told_apart = "move the light: a stain stays"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
