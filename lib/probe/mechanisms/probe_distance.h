// probe.distance on the way to a lamp: at the direction u from the balls' middle o and the inverse distance q, the lamp
// lies from a point p in the direction of u - q (p - o); q = 0 is infinitely far.
#pragma once
#include "geom/vector.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& probe_distance();
}

namespace gonio::equation {

// Of the length |lamp - p| q, which is 1 for lamps that are infinitely far. `from_middle_m`: p - o.
constexpr Vec3 probe_distance(Vec3 direction, Vec3 from_middle_m, double inverse_distance_per_m) {
  return direction - from_middle_m * inverse_distance_per_m;
}

}  // namespace gonio::equation
