// geometry.scale: prints shrink. Equation: scene/placement.cpp.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& geometry_scale() {
  static const Mechanism declaration{
      .id = "geometry.scale",
      .sentence = "The object is a little larger or smaller than its model.",
      .typical = "1 to 6 %, the shrinkage of a print",
      .equation = "x_object' = (1 + growth) x_object",
      .source = "shrinkage of printed parts as measured with calipers",
      .stage = "geometry",
      .target = Target::object,
      .domains = {"images", "outlines"},
      .parameters = {{.name = "growth",
                      .unit = "1",
                      .neutral = 0,
                      .lower = -0.1,
                      .upper = 0.1,
                      .start = 0.005,
                      .typical = 0.03,
                      .meaning = "relative growth in all directions, about the origin of the object's frame"}},
      .conditions = {"image.edge-distance", "camera.edge-shift-x", "camera.edge-shift-y", "camera.edge-shift-radial",
                     "surface.exitance-angle"},
      .mistaken_for = {{.with = "geometry.pose", .told_apart = "caliper, or a second view"},
                       {.with = "focal length", .told_apart = "a second range"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
