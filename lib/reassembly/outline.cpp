// The tangents that an outline's covariance speaks of, and what its size says about its distance.
#include "reassembly/outline.h"

#include <cmath>

namespace gonio::reassembly {

Vec3 across_of(Vec3 axis) {
  const Vec3 across = cross({0, 1, 0}, axis);
  return norm(across) > 1e-9 ? normalized(across) : Vec3{1, 0, 0};
}

double distance_m(const Outline& outline, double radius_m) {
  return radius_m / std::sin(outline.half_angle_rad);
}

}  // namespace gonio::reassembly
