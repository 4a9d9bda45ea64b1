// light.direction: the lamp is not quite where it was measured. Equation: light/turn.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& light_direction() {
  static const Mechanism declaration{
      .id = "light.direction",
      .sentence = "The light comes from a slightly different direction than was written down.",
      .typical = "1 to 10 degrees",
      .equation =
          "towards' = R(tilt_x t + tilt_y b) towards, t and b at right angles to towards; for lamps at a finite "
          "distance the position is turned so about the scene's centre",
      .source = "Rodrigues 1840; calibrated from a mirror ball: Powell, Sarkar & Goldgof 2001",
      .stage = "light",
      .target = Target::light,
      .domains = {"tables", "images", "stacks"},
      .parameters = {{.name = "tilt_x_rad",
                      .unit = "rad",
                      .neutral = 0,
                      .lower = -0.35,
                      .upper = 0.35,
                      .start = 0,
                      .typical = 0.035,
                      .meaning = "turn about the axis x carried along from +z to the light"},
                     {.name = "tilt_y_rad",
                      .unit = "rad",
                      .neutral = 0,
                      .lower = -0.35,
                      .upper = 0.35,
                      .start = 0,
                      .typical = 0.035,
                      .meaning = "turn about the axis y carried along from +z to the light"}},
      .conditions = {"light.identity", "surface.incidence-angle", "light.shadow-edge-distance"},
      .mistaken_for = {{.with = "albedo gradient",
                        .told_apart = "a mirror ball beside the object shows where the light is"},
                       {.with = "surface.diffuse-roughness", .told_apart = "more lights around the same object"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
