// ct.streak on line integrals, and on what filtered back-projection, which is linear, makes of them.
#pragma once
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& ct_streak();
}

namespace gonio::equation {

// What a ray whose path through markers is m lacks for each share; longest: the largest such path.
inline double ct_streak_lacks(double m, double longest) {
  return m * m / longest;
}
// lacks: the above, or its reconstruction, with `value` accordingly.
inline double ct_streak(double value, double streak, double lacks) {
  return value - streak * lacks;
}

}  // namespace gonio::equation
