// ct.threshold: a surface that was cut at another value than half-way.
#include "volume/mechanisms/ct_threshold.h"

namespace gonio::mechanism {

const Mechanism& ct_threshold() {
  static const Mechanism declaration{
      .id = "ct.threshold",
      .sentence =
          "The surface was cut at another value than half-way between air and material: every wall is off by the same "
          "distance along its normal.",
      .typical = "0.05 to 0.5 voxel",
      .equation = "s = offset_voxels for the wall's place s along the outward normal of the believed surface",
      .source = "Carmignato, Dewulf & Leach, Industrial X-Ray Computed Tomography, 2018, section 3.4 (ISO 50)",
      .stage = "tomograph",
      .target = Target::scene,
      .domains = {"volumes"},
      .parameters = {{.name = "offset_voxels",
                      .unit = "1",
                      .lower = -2,
                      .upper = 2,
                      .start = 0.1,
                      .typical = 0.2,
                      .meaning = "how far the walls lie outside of the believed surface, in voxels of the smallest "
                                 "spacing"}},
      .conditions = {"volume.curvature", "volume.size", "volume.edge-azimuth", "volume.height"},
      .mistaken_for = {{.with = "ct.scale",
                        .told_apart = "scan an object with outer and inner walls, or one that is thin and long"},
                       {.with = "geometry.offset", .told_apart = "measure the object with a caliper"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
