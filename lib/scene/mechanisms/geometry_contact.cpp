// geometry.contact: what is soft gives way. Equation: scene/placement.cpp.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& geometry_contact() {
  static const Mechanism declaration{
      .id = "geometry.contact",
      .sentence = "The object has sunk into what it lies on, or the other way round.",
      .typical = "0.1 to 2 mm",
      .equation = "x' = x - depth_m z, z the world's vertical",
      .source = "indentation of a soft support",
      .stage = "geometry",
      .target = Target::object,
      .domains = {"images", "tables"},
      .parameters = {{.name = "depth_m",
                      .unit = "m",
                      .neutral = 0,
                      .lower = -0.005,
                      .upper = 0.005,
                      .start = 0.0005,
                      .typical = 5e-4,
                      .meaning = "by which the object lies deeper"}},
      .conditions = {"image.edge-distance", "camera.edge-shift-x", "camera.edge-shift-y", "light.shadow-edge-distance",
                     "marker.height"},
      .mistaken_for = {{.with = "geometry.pose", .told_apart = "lift the object and lay it on a hard support"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
