// marker.refracted on where a marker seems to be.
#pragma once
#include <span>

#include "geom/vector.h"
#include "mechanism/mechanism.h"
#include "reassembly/marker_rows.h"

namespace gonio::mechanism {
const Mechanism& marker_refracted();
}

namespace gonio::equation {

// Where the marker at `marker_m` seems to stand to a camera at `camera_m` that sees it through walls of index `eta`:
// the ray of sight is refracted where the straight line `from` -> `to` (on which the walls were found) goes in and out
// of each wall, at faces that turn along the wall as they do between these two places. Equal to marker_m, to the last
// bit, at eta = 1. Where a wall reflects totally the marker is taken to stand where it is.
Vec3 marker_refracted(Vec3 camera_m, Vec3 marker_m, Vec3 from_m, Vec3 to_m,
                      std::span<const reassembly::GlassWall> walls, double eta);

}  // namespace gonio::equation
