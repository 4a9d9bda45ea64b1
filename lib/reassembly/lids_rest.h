// Where a body comes to rest by sinking and tilting alone, its gaps linear in both. Local frame about its centre of
// mass, z down.
#pragma once
#include <cstddef>
#include <span>
#include <vector>

#include "geom/vector.h"

namespace gonio::reassembly {

struct Gap {
  Vec3 at;      // from the centre of mass
  Vec3 normal;  // of the plane that would touch, scaled so that its z is -1
  double gap = 0;
};
struct Rest {
  double sinking = 0;  // of the centre of mass
  Vec2 tilt;           // about x and y, rad
  std::vector<std::size_t> feet;
  bool falls = false;  // nothing holds it within the limits
};
struct RestLimits {
  double clearance = 0, most_tilt = 0, most_sinking = 0;
};
// max s  under  s + tilt.x (n.y z + y) - tilt.y (n.x z + x) <= gap - clearance  for all gaps.
Rest rest_on(std::span<const Gap> gaps, const RestLimits& limits);

}  // namespace gonio::reassembly
