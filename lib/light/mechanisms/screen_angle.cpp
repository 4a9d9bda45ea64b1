// screen.angle: a screen's direction of polarization beside what is stated.
#include "light/mechanisms/screen_angle.h"

namespace gonio::mechanism {

const Mechanism& screen_angle() {
  static const Mechanism declaration{
      .id = "screen.angle",
      .sentence = "A screen's light swings along another direction than was believed.",
      .typical = "0.5 to 3 degrees; 45 degrees where it was never looked up",
      .equation = "polarization_rad' = polarization_rad + turn_rad",
      .source = "Fainman & Shamir 1984 (sheet polarizers)",
      .stage = "light",
      .target = Target::light,
      .domains = {"polarization"},
      .parameters = {{.name = "turn_rad",
                      .unit = "rad",
                      .neutral = 0,
                      .lower = -0.8,
                      .upper = 0.8,
                      .start = 0.03,
                      .typical = 0.03,
                      .meaning = "from the right towards up for who looks at it"}},
      .conditions = {"screen.polarized-across"},
      .mistaken_for = {{.with = "polarizer.angle", .told_apart = "light that a surface has polarized"},
                       {.with = "geometry.pose", .told_apart = "edges in the picture tell how the screen is rolled"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
