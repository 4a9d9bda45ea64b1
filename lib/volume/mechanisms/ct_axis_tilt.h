// ct.axis-tilt on walls and the widths of edges. The view whose rays touch a wall is the one that places it; the tilt
// turns the place about these rays, to one side for normals that the views of half a turn meet from the right, to the
// other for those met from the left. Over a whole turn both happen, and the edge is spread instead.
#pragma once
#include <cmath>

#include "geom/vector.h"
#include "mechanism/mechanism.h"

namespace gonio::mechanism {
const Mechanism& ct_axis_tilt();
}

namespace gonio::equation {

// What an angle about the rays that touch a wall moves it by, over the angle: x the place from the volume's centre, n
// the outward normal; the rotation axis is z. None where no ray of a slice touches it.
inline double ct_axis_tilt_lever_m(Vec3 x_m, Vec3 n) {
  const double level = std::hypot(n.x, n.y);
  if (!(level > 1e-6)) return 0;
  return x_m.z * level - n.z * (x_m.x * n.x + x_m.y * n.y) / level;
}
// Views over half a turn: where a wall stands along its normal, lengths in the lever's unit.
inline double ct_axis_tilt(double s, double tilt_rad, double first_rad, double azimuth_rad, double lever) {
  return s + tilt_rad * std::tanh(8 * std::sin(azimuth_rad - first_rad)) * lever;
}
// Over a whole turn: how wide its edge is.
inline double ct_axis_tilt_width(double width, double wobble_rad, double lever) {
  return std::hypot(width, wobble_rad * lever);
}

}  // namespace gonio::equation
