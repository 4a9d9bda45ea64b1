// light.inverse-square: light of a lamp that stands at a finite distance, over what it gives in the origin.
#pragma once
#include "geom/vector.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& light_inverse_square();
}

namespace gonio::equation {

// The lamp stands at 1 / nearness_per_m from the origin in the direction `towards` (unit). The vector from a point to
// it, over that distance: `towards` itself at nearness 0.
inline Vec3 light_inverse_square_arm(double nearness_per_m, Vec3 towards, Vec3 point_m) {
  return towards - point_m * nearness_per_m;
}
// (D / d)^2 from that vector.
inline double light_inverse_square(Vec3 arm) {
  return 1 / dot(arm, arm);
}

}  // namespace gonio::equation
