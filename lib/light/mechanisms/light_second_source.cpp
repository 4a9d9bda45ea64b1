// light.second-source: a window, another lamp. Equation: scene/mechanisms.cpp, add_second_source().
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& light_second_source() {
  static const Mechanism declaration{
      .id = "light.second-source",
      .sentence = "A further light that nobody wrote down shines in all pictures from one place.",
      .typical = "0.1 to 20 % of the lamp",
      .equation =
          "E += watt_per_m2 V max(0, n.l) (D / r)^2, V 1 where nothing is in the way; D, r and l lead to it from the "
          "middle and from the point: D along (cos(el) cos(az), cos(el) sin(az), sin(el)), 1 / nearness_per_m away; in "
          "tables as far as the first lamp",
      .source = "Lambert 1760; Kepler 1604",
      .stage = "light",
      .target = Target::scene,
      .domains = {"tables", "images"},
      .parameters = {{.name = "watt_per_m2",
                      .unit = "W/m^2",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 1000,
                      .start = 0.05,
                      .meaning = "irradiance that it gives a plane facing it in the middle, all colours alike"},
                     {.name = "azimuth_rad",
                      .unit = "rad",
                      .neutral = 0,
                      .lower = -6.3,
                      .upper = 6.3,
                      .start = 0,
                      .meaning =
                          "of the direction to it, about the world's z from x; without effect where watt_per_m2 is 0"},
                     {.name = "elevation_rad",
                      .unit = "rad",
                      .neutral = 0.8,
                      .lower = -1.5,
                      .upper = 1.6,
                      .start = 0.8,
                      .meaning =
                          "of the direction to it, above the world's xy plane; without effect where watt_per_m2 is 0"},
                     {.name = "nearness_per_m",
                      .unit = "1/m",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 10,
                      .start = 0.5,
                      .typical = 1,
                      .meaning = "one over its distance from the middle; 0: infinitely far; without effect where "
                                 "watt_per_m2 is 0"}},
      .conditions = {"light.visibility", "scene.ambient-visibility", "surface.exitance-angle"},
      .mistaken_for = {{.with = "transport.indirect", .told_apart = "cover it"},
                       {.with = "light.ambient", .told_apart = "cover it; or look for second shadows"},
                       {.with = "surface.interface", .told_apart = "cover it"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
