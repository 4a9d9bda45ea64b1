// geometry.shrinkage: prints shrink, and not alike in all directions. Equation: scene/edits/geometry_shrinkage.cpp.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& geometry_shrinkage() {
  static const auto along = [](const char* name, const char* meaning) {
    return Parameter{.name = name,
                     .unit = "1",
                     .neutral = 0,
                     .lower = -0.5,
                     .upper = 0.5,
                     .start = 0.01,
                     .typical = 0.03,
                     .meaning = meaning};
  };
  static const Mechanism declaration{
      .id = "geometry.shrinkage",
      .sentence = "The object is smaller than its model by other shares along each of the model's axes.",
      .typical = "1 to 6 %",
      .equation = "x' = middle + diag(1 - shrink) (x - middle), middle that of the model's box",
      .source = "a printed figure: 3, 6 and 1 % (Hannemose et al. 2020)",
      .stage = "geometry",
      .target = Target::object,
      .domains = {"outlines"},
      .parameters = {along("shrink_x", "share by which it is smaller along the model's x"),
                     along("shrink_y", "share by which it is smaller along the model's y"),
                     along("shrink_z", "share by which it is smaller along the model's z")},
      .conditions = {"image.edge-distance", "camera.edge-shift-x", "camera.edge-shift-y"},
      .mistaken_for = {{.with = "geometry.scale", .told_apart = "views from two sides"},
                       {.with = "geometry.pose", .told_apart = "caliper, or a second view"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
