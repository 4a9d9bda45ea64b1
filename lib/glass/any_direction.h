// A direction drawn evenly over the sphere.
#pragma once
#include <cmath>

#include "base/random.h"
#include "geom/vector.h"

namespace gonio::glass {

inline Vec3 any_direction(Random& random) {
  const double z = random.uniform(-1, 1), phi = random.uniform(0, 2 * pi), r = std::sqrt(1 - z * z);
  return {r * std::cos(phi), r * std::sin(phi), z};
}

}  // namespace gonio::glass
