// marker.offset: markers are glued on, and glue is as thick as it is.
#include "reassembly/mechanisms/marker_offset.h"

namespace gonio::mechanism {

const Mechanism& marker_offset() {
  static const Mechanism declaration{
      .id = "marker.offset",
      .sentence = "Markers sit outside of the surface by a constant: what glues them on is as thick as it is.",
      .typical = "0.02 to 0.5 mm, a layer of glue or of adhesive tape",
      .equation = "x' = x + thickness_m n: n the outward normal of the piece at the marker",
      .source = "Luhmann et al., Close-Range Photogrammetry, 3rd ed. (2020), section 3.6.1: offset of targets",
      .stage = "geometry",
      .target = Target::scene,
      .domains = {"tables"},
      .parameters = {{.name = "thickness_m",
                      .unit = "m",
                      .lower = -0.005,
                      .upper = 0.005,
                      .start = 0.0002,
                      .typical = 2e-4,
                      .meaning = "by which markers sit further out than the piece's description has them"}},
      .conditions = {"surface.exitance-angle"},
      .mistaken_for = {{.with = "ct.scale",
                        .told_apart = "put markers near the middle and far from it, and on inner and outer walls: on a "
                                      "ball the two are the same"},
                       {.with = "geometry.offset", .told_apart = "measure the glue at one marker with a caliper"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
