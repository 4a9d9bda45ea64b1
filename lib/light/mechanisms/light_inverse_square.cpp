// light.inverse-square: a lamp that is not infinitely far.
#include "light/mechanisms/light_inverse_square.h"

namespace gonio::mechanism {

const Mechanism& light_inverse_square() {
  static const Mechanism declaration{
      .id = "light.inverse-square",
      .sentence = "The lamp is near: its light falls with the square of the distance, and its rays are not parallel.",
      .typical = "10 to 80 % across the object",
      .equation =
          "E *= (D / d)^2, D = 1 / nearness_per_m the distance of the scene's centre from the lamp, d the point's",
      .source = "Lambert 1760",
      .stage = "light",
      .target = Target::light,
      .domains = {"tables", "images", "stacks"},
      .parameters = {{.name = "nearness_per_m",
                      .unit = "1/m",
                      .neutral = 0,
                      .lower = 0,
                      .upper = 20,
                      .start = 0.2,
                      .typical = 1,
                      .meaning = "one over the lamp's distance; 0: infinitely far"}},
      .conditions = {"light.distance", "surface.incidence-angle"},
      .mistaken_for = {{.with = "light.lobe", .told_apart = "move the light, or the patch, along the axis"},
                       {.with = "optics.vignetting", .told_apart = "move the patch together with the light"}},
      .inputs = {{.name = "distance_m", .unit = "m", .lower = 0, .upper = 10}},  // further away than the origin
      .act =
          [](double v, std::span<const double> at, std::span<const double> p) {
            const Vec3 axis{0, 0, 1};
            return v * equation::light_inverse_square(equation::light_inverse_square_arm(p[0], axis, axis * -at[0]));
          },
  };
  return declaration;
}

}  // namespace gonio::mechanism
