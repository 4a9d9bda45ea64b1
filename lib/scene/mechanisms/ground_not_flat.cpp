// ground.not-flat: paper does not lie flat. Equation: scene/mechanisms/bend.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& ground_not_flat() {
  static const auto curvature = [](const char* name, const char* meaning) {
    return Parameter{.name = name,
                     .unit = "1/m",
                     .neutral = 0,
                     .lower = -5,
                     .upper = 5,
                     .start = 0.1,
                     .typical = 0.3,
                     .meaning = meaning};
  };
  static const Mechanism declaration{
      .id = "ground.not-flat",
      .sentence = "What the object stands on is not flat, so that its shadow falls elsewhere than on a plane.",
      .typical = "0.5 to 5 mm over 200 mm of paper",
      .equation =
          "height = (curl_x_per_m x^2 + 2 twist_per_m x y + curl_y_per_m y^2) / 2, x and y from the plane's "
          "middle",
      .source = "Timoshenko & Woinowsky-Krieger 1959, section 9; seen on paper: Hannemose et al. 2020",
      .stage = "geometry",
      .target = Target::object,
      .domains = {"outlines"},
      .parameters = {curvature("curl_x_per_m", "curvature along the plane's x, upwards"),
                     curvature("curl_y_per_m", "curvature along the plane's y, upwards"),
                     curvature("twist_per_m", "by which the slope along x grows along y")},
      .conditions = {"ground.x", "ground.y", "light.identity"},
      .mistaken_for = {{.with = "light.position", .told_apart = "a second lamp, whose shadow falls elsewhere"},
                       {.with = "geometry.bend", .told_apart = "rims of the object itself stay where they are"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
