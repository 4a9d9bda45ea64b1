// geometry.offset: the surface lies outside or inside of where a scan puts it. Equation: scene/placement.cpp.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& geometry_offset() {
  static const Mechanism declaration{
      .id = "geometry.offset",
      .sentence =
          "The whole surface lies a little outside or inside of the model's, as where a scan was cut at another "
          "threshold.",
      .typical = "0.1 to 1 voxel",
      .equation = "x' = x + offset_m n, n the outward normal",
      .source = "iso-surface of a CT scan: Carmignato, Dewulf & Leach 2018",
      .stage = "geometry",
      .target = Target::object,
      .domains = {"images", "outlines"},
      .parameters = {{.name = "offset_m",
                      .unit = "m",
                      .neutral = 0,
                      .lower = -0.003,
                      .upper = 0.003,
                      .start = 0.0002,
                      .typical = 3e-4,
                      .meaning = "along the outward normals"}},
      .conditions = {"image.edge-distance", "camera.edge-shift-x", "camera.edge-shift-y", "camera.edge-shift-radial",
                     "surface.exitance-angle"},
      .mistaken_for = {{.with = "geometry.scale", .told_apart = "caliper at a thin and at a thick part"},
                       {.with = "volume.index", .told_apart = "caliper"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
