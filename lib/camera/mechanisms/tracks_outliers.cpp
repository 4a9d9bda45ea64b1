// tracks.outliers: tracks that slipped. Equation: explain/tables/models/tracks.cpp.
#include "mechanism/mechanism.h"

namespace gonio::mechanism {

const Mechanism& tracks_outliers() {
  static const Mechanism declaration{
      .id = "tracks.outliers",
      .sentence =
          "Single tracks slipped, for a frame, for some or from a frame on: they follow another spot than the point "
          "they began on.",
      .typical = "a few tracks in a hundred, by several px",
      .equation = "(u, v) += (slip_u_px, slip_v_px) for the named points, from the named frames on or in them",
      .source = "Kalal, Mikolajczyk & Matas, ICPR 2010 (forward-backward error), for what it is and how it is caught",
      .stage = "sensor",
      .target = Target::scene,
      .domains = {"tables", "nrsfm"},
      .parameters = {{.name = "slip_u_px",
                      .unit = "px",
                      .lower = -1000,
                      .upper = 1000,
                      .typical = 5,
                      .meaning = "displacement along the rows, one number a track"},
                     {.name = "slip_v_px",
                      .unit = "px",
                      .lower = -1000,
                      .upper = 1000,
                      .typical = 5,
                      .meaning = "displacement along the columns, one number a track"}},
      .conditions = {"tracks.point"},
      .mistaken_for = {{.with = "deformation", .told_apart = "track the film backwards and compare"}},
  };
  return declaration;
}

}  // namespace gonio::mechanism
