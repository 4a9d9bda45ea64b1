// A small height map with a hole, for tests of what is written and read again.
#pragma once
#include <cmath>

#include "base/random.h"
#include "io/height_map.h"

namespace gonio::io {

inline constexpr int random_map_hole = 8;

inline HeightMap random_map() {
  HeightMap map{7, 5, 2e-6, 3e-6, {}};
  Random random(4);
  for (int i = 0; i < 35; ++i) map.z_m.push_back(1e-6 * random.normal());
  map.z_m[random_map_hole] = std::nan("");
  return map;
}

}  // namespace gonio::io
