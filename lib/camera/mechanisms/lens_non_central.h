// Where a ray crosses the axis: lens.non-central. Camera frame, metres.
#pragma once
#include <cmath>

#include "geom/vector.h"

namespace gonio::equation {

// Height s = pupil_m sin^2 theta at which the ray along `direction` (of any length) crosses the axis.
inline double lens_non_central(double pupil_m, Vec3 direction) {
  const double across2 = direction.x * direction.x + direction.y * direction.y;
  return pupil_m * across2 / (across2 + direction.z * direction.z);
}

// The same for the ray that passes through a point: s solves s = pupil_m sin^2 theta(X, Y, Z - s). The iteration
// contracts by about s over the distance.
inline double lens_non_central_place(double pupil_m, Vec3 point_m) {
  double s = 0;
  for (int i = 0; i < 50 && pupil_m != 0; ++i) {
    const double before = s;
    s = lens_non_central(pupil_m, {point_m.x, point_m.y, point_m.z - before});
    if (std::abs(s - before) < 1e-15) break;
  }
  return s;
}

}  // namespace gonio::equation
