// light.near-environment: the walls of a room instead of a sky. Equation: light/near_environment.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& light_near_environment() {
  static const Mechanism declaration{
      .id = "light.near-environment",
      .sentence = "The surroundings that light the scene are near: things at different places see them differently.",
      .typical = "walls at 2 to 5 m: 10 to 30 % across half a metre",
      .equation =
          "along d at the centre becomes along (d - p nearness_per_m) at p, E *= cos(e) / |d - p nearness_per_m|^2, e "
          "the angle between both",
      .source = "Debevec 1998, section 6 (local scene within a distant one); radiance theorem, Nicodemus 1963",
      .stage = "light",
      .target = Target::light,
      .domains = {"images"},
      .parameters = {{.name = "nearness_per_m",
                      .unit = "1/m",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 5,
                      .start = 0.2,
                      .typical = 0.3,
                      .meaning = "one over the distance of the walls from the scene's centre; 0: infinitely far"}},
      .conditions = {"scene.x", "scene.y", "scene.z", "surface.incidence-angle"},
      .mistaken_for = {{.with = "geometry.pose", .told_apart = "a second light probe, at another place"},
                       {.with = "light.inverse-square", .told_apart = "switch the lamps on one by one"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
