// probe.distance: lamps that are nearer than infinitely far.
#include "probe/mechanisms/probe_distance.h"

namespace gonio::mechanism {

const Mechanism& probe_distance() {
  static const Mechanism declaration{
      .id = "probe.distance",
      .sentence =
          "The lamps that a mirror ball shows stand near, at some distance, and are not infinitely far: balls and "
          "views "
          "that stand apart see them in different directions.",
      .typical = "rooms and cabinets: 0.3 to 5 m",
      .equation =
          "the lamp lies from the point p in the direction of u - inverse_distance_per_m (p - o), u its direction from "
          "the balls' middle o; the highlight is where the ball mirrors that into the camera (Alhazen's problem)",
      .source = "Powell, Sarkar & Goldgof, IEEE PAMI 23 (2001) 1022-1027; Lensch et al. 2003: lights by several balls",
      .stage = "light",
      .target = Target::light,
      .domains = {"tables"},
      .parameters = {{.name = "inverse_distance_per_m",
                      .unit = "1/m",
                      .lower = 0,
                      .upper = 20,
                      .start = 0.5,
                      .typical = 0.5,
                      .meaning = "one over the lamp's distance from the balls' middle; 0: infinitely far"}},
      .conditions = {"light.identity"},
      .mistaken_for = {{.with = "probe.centre",
                        .told_apart = "move a ball by a known length across the view, or photograph it from a further "
                                      "side: a distance foretells where the highlights go"},
                       {.with = "lens.radial",
                        .told_apart = "photograph the ball in the middle of the picture and at its edge"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
