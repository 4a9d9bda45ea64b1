// Rotation of light directions (light/turn.h).
#include "light/turn.h"

#include "geom/rigid.h"

namespace gonio::light {

Vec3 turned(Vec3 towards, double tilt_x_rad, double tilt_y_rad) {
  if (tilt_x_rad == 0 && tilt_y_rad == 0) return towards;
  const Basis basis(towards);
  const Vec3 axis = basis.t * tilt_x_rad + basis.b * tilt_y_rad;
  return normalized(matrix_of(quaternion_of_rotation_vector(axis)) * towards);
}

Vec3 turned_about(Vec3 position_m, double tilt_x_rad, double tilt_y_rad, Vec3 centre_m) {
  const Vec3 arm = position_m - centre_m;
  const double length = norm(arm);
  if ((tilt_x_rad == 0 && tilt_y_rad == 0) || length == 0) return position_m;
  return centre_m + turned(arm / length, tilt_x_rad, tilt_y_rad) * length;
}

}  // namespace gonio::light
