// ct.streak on line integrals, and on what filtered back-projection, which is linear, makes of them.
#pragma once
#include <cmath>

#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& ct_streak();
}

namespace gonio::equation {

// What a ray of line integral p, `without` of it in the object, lacks for each share: the square, but for the object's
// own, which is ct.beam-hardening. Of balls alone it would stay within them, for a shadow that all views see alike
// reconstructs to what casts it: streaks come of what else lies in the ray.
inline double ct_streak_lacks(double p, double without) {
  return p * p - without * without;
}
// What a ray of that transmission lacks where the detector reads `floor` too much behind markers.
inline double ct_streak_floor_lacks(double transmission, double without, double floor) {
  return std::log1p(floor / transmission) - std::log1p(floor / without);
}
// lacks: the above, or its reconstruction, with `value` accordingly.
inline double ct_streak(double value, double streak, double lacks) {
  return value - streak * lacks;
}

}  // namespace gonio::equation
