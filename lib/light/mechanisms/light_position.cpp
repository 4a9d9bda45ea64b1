// light.position: the lamp stands elsewhere. Equation: scene/mechanisms.cpp, shift().
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
namespace {

Parameter along(const char* name, const char* axis) {
  return {.name = name,
          .unit = "m",
          .neutral = 0,
          .lower = -0.1,
          .upper = 0.1,
          .start = 0.002,
          .typical = 0.005,
          .meaning = axis};
}

}  // namespace

const Mechanism& light_position() {
  static const Mechanism declaration{
      .id = "light.position",
      .sentence = "The lamp stands some way from where it was written down.",
      .typical = "1 to 20 mm, or 1 to 10 degrees as seen from the object",
      .equation = "position_m' = position_m + (shift_x_m, shift_y_m, shift_z_m)",
      .source = "near lights calibrated from highlights: Ackermann, Fuhrmann & Goesele 2013",
      .stage = "light",
      .target = Target::light,
      .domains = {"images", "outlines", "traced"},
      .parameters = {along("shift_x_m", "by which the lamp stands further along the world's x"),
                     along("shift_y_m", "by which the lamp stands further along the world's y"),
                     along("shift_z_m", "by which the lamp stands further along the world's z")},
      .conditions = {"light.identity", "light.distance", "surface.incidence-angle", "light.shadow-edge-distance"},
      .mistaken_for = {{.with = "light.direction", .told_apart = "a second object at another distance from the lamp"},
                       {.with = "albedo gradient",
                        .told_apart = "a mirror ball beside the object shows where the light is"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
