// geometry.bend: printed parts curl as they cool. Equation: scene/mechanisms/bend.h.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& geometry_bend() {
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
      .id = "geometry.bend",
      .sentence =
          "The object is bent: its ends stand higher or lower than the model's, as those of a print that curls.",
      .typical = "0.1 to 1 mm over 100 mm",
      .equation =
          "z' = z + (curl_x_per_m x^2 + 2 twist_per_m x y + curl_y_per_m y^2) / 2, x and y from the middle of "
          "the model's box",
      .source = "Timoshenko & Woinowsky-Krieger 1959, section 9; warp of prints: Wang, Xi & Jin 2007",
      .stage = "geometry",
      .target = Target::object,
      .domains = {"outlines"},
      .parameters = {curvature("curl_x_per_m", "curvature along the model's x, towards its z"),
                     curvature("curl_y_per_m", "curvature along the model's y, towards its z"),
                     curvature("twist_per_m", "by which the slope along x grows along y")},
      .conditions = {"mesh.x", "mesh.y", "rim.direction-z"},
      .mistaken_for = {{.with = "geometry.pose", .told_apart = "lay it on a flat plate and look beneath its ends"},
                       {.with = "ground.not-flat", .told_apart = "views of the object itself, not of its shadow"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
