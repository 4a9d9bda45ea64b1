// probe.centre: a ball that is elsewhere, or larger, than its outline says. Equation:
// explain/tables/models/probe.cpp.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
namespace {

Parameter length(const char* name, const char* meaning) {
  return {.name = name,
          .unit = "m",
          .neutral = 0,
          .lower = -0.02,
          .upper = 0.02,
          .start = 2e-4,
          .typical = 3e-4,
          .meaning = meaning};
}

}  // namespace

const Mechanism& probe_centre() {
  static const Mechanism declaration{
      .id = "probe.centre",
      .sentence =
          "The mirror ball stands elsewhere than it was taken to stand, or has another radius, beyond what its outline "
          "leaves open.",
      .typical = "0.1 to 1 mm: an outline that was read where the background goes on in the ball, a ball that rolled",
      .equation =
          "centre' = centre + (shift_x_m, shift_y_m, shift_z_m), radius' = radius + radius_change_m; a normal turns by "
          "shift / radius, what is seen in it by twice that",
      .source = "Lensch et al., Machine Vision & Applications 14 (2003): calibration by spheres",
      .stage = "pose",
      .target = Target::scene,
      .domains = {"tables"},
      .parameters = {length("shift_x_m", "by which the ball's centre lies further along the world's x"),
                     length("shift_y_m", "by which the ball's centre lies further along the world's y"),
                     length("shift_z_m", "by which the ball's centre lies further along the world's z"),
                     length("radius_change_m", "by which the ball's radius is larger than stated")},
      .conditions = {"probe.shift-x", "probe.shift-y", "probe.shift-z", "surface.incidence-angle"},
      .mistaken_for = {{.with = "probe.distance",
                        .told_apart = "photograph the ball from three sides or more: of one side neither can be told"},
                       {.with = "camera.pose",
                        .told_apart =
                            "of two balls in one view only one against the other is seen; draw the outline of "
                            "each by a silhouette, and photograph a board beside them in every view"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
