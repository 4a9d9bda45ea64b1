// marker.offset on where a marker is.
#pragma once
#include "geom/vector.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& marker_offset();
}

namespace gonio::equation {

// `normal`: outward unit normal of the piece at the marker.
constexpr Vec3 marker_offset(Vec3 x_m, Vec3 normal, double thickness_m) {
  return x_m + normal * thickness_m;
}

}  // namespace gonio::equation
