// ct.scale: voxels are not as large as the file says.
#include "volume/mechanisms/ct_scale.h"

namespace gonio::mechanism {

const Mechanism& ct_scale() {
  static const Mechanism declaration{
      .id = "ct.scale",
      .sentence = "Voxels are not as large as the file says: all lengths of the volume are off by the same share.",
      .typical = "0.05 to 0.5 %, the magnification's error of a cone beam",
      .equation =
          "s = n.(scale x + axial z e_z) / voxel: x the place from the volume's centre, n the outward normal, z along "
          "the rotation axis e_z",
      .source = "Kruth et al., CIRP Annals 60 (2011) 821-842, section 4.1: the scale error of a source-object distance",
      .stage = "tomograph",
      .target = Target::scene,
      .domains = {"volumes", "tables"},
      .parameters = {{.name = "scale",
                      .unit = "1",
                      .lower = -0.05,
                      .upper = 0.05,
                      .start = 0.002,
                      .typical = 0.002,
                      .meaning = "share by which the volume is larger than the believed shape"},
                     {.name = "axial",
                      .unit = "1",
                      .lower = -0.05,
                      .upper = 0.05,
                      .start = 0.002,
                      .typical = 0.002,
                      .meaning = "the same along the rotation axis alone, beside scale"}},
      .conditions = {"volume.size", "volume.height", "marker.distance-from-origin"},
      .mistaken_for = {{.with = "ct.threshold",
                        .told_apart = "scan an object with outer and inner walls, or one that is thin and long"},
                       {.with = "marker.offset", .told_apart = "markers near the middle of the piece and far from it"},
                       {.with = "geometry.scale", .told_apart = "measure the object with a caliper"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
