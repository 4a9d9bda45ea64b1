// ct.axis-tilt: the rotation axis leans against the detector.
#include "volume/mechanisms/ct_axis_tilt.h"

namespace gonio::mechanism {

const Mechanism& ct_axis_tilt() {
  static const Mechanism declaration{
      .id = "ct.axis-tilt",
      .sentence =
          "The rotation axis leans against the detector's columns: walls on one side move out and on the other in, the "
          "more the further from the middle slice; over a whole turn they double.",
      .typical = "0.1 to 2 degrees",
      .equation =
          "s = tilt_rad q(phi - first_rad) (z |n_xy| - n_z x.n_xy / |n_xy|) / voxel over half a turn: x the place from "
          "the volume's centre, n the outward normal, phi its azimuth, q = tanh(8 sin) one of the first view's two "
          "sides; over a whole turn w' = sqrt(w^2 + (wobble_rad (...) / voxel)^2) for the edges' width w",
      .source =
          "the view whose rays touch a wall places it, turned by the tilt about those rays; Yang et al., Medical "
          "Physics 33 (2006) 1695-1706 for what a tilt does to a reconstruction",
      .stage = "tomograph",
      .target = Target::scene,
      .domains = {"volumes"},
      .parameters = {{.name = "tilt_rad",
                      .unit = "rad",
                      .lower = -0.1,
                      .upper = 0.1,
                      .start = 0.005,
                      .typical = 0.01,
                      .meaning = "of the axis against the detector's columns, views over half a turn"},
                     {.name = "first_rad",
                      .unit = "rad",
                      .lower = -0.2,
                      .upper = 3.3,
                      .start = 0,
                      .meaning = "azimuth at which one side ends and the other begins"},
                     {.name = "wobble_rad",
                      .unit = "rad",
                      .lower = 0,
                      .upper = 0.1,
                      .start = 0.01,
                      .typical = 0.01,
                      .meaning = "the tilt, views over a whole turn"}},
      .conditions = {"volume.azimuth-by-height", "volume.edge-azimuth", "volume.height"},
      .mistaken_for = {{.with = "the object's pose",
                        .told_apart = "look at walls all round, above and below the middle"},
                       {.with = "ct.blur", .told_apart = "look at edges near and far from the middle slice"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
