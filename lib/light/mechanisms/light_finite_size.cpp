// light.finite-size: lamps have a size. Equation: light/sphere_emitter.cpp; in closed form light/irradiance.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& light_finite_size() {
  static const Mechanism declaration{
      .id = "light.finite-size",
      .sentence = "The lamp is not a point but has a size, so that shadows have a soft edge.",
      .typical = "penumbrae of 1 to 20 px",
      .equation =
          "L = watt_per_sr / (pi radius_m^2) over the directions that a sphere of radius_m fills; penumbra width about "
          "2 radius_m (distance to the occluder) / (distance from lamp to occluder)",
      .source = "Lambert 1760; Shirley, Wang & Zimmerman 1996, section 3.2.1",
      .stage = "light",
      .target = Target::light,
      .domains = {"tables", "images", "outlines"},
      .parameters = {{.name = "radius_m",
                      .unit = "m",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 0.2,
                      .start = 0.01,
                      .typical = 0.01,
                      .meaning = "radius of the lamp"}},
      .conditions = {"light.shadow-edge-distance", "light.visibility", "light.distance"},
      .mistaken_for = {{.with = "optics.defocus", .told_apart = "move the light: a penumbra grows, blur stays"},
                       {.with = "transport.indirect", .told_apart = "black cloth around the shadow"},
                       {.with = "surface.subsurface", .told_apart = "the profile of a point spot on the surface"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
