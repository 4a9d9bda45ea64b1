// Rotation of light directions (light/turn.h).
#include "light/turn.h"

#include "geom/rigid.h"

namespace gonio::light {
namespace {

Mat3 rotation_of(Vec3 towards, double tilt_x_rad, double tilt_y_rad) {
  const Basis basis(towards);
  return matrix_of(quaternion_of_rotation_vector(basis.t * tilt_x_rad + basis.b * tilt_y_rad));
}

}  // namespace

Vec3 turned(Vec3 towards, double tilt_x_rad, double tilt_y_rad) {
  if (tilt_x_rad == 0 && tilt_y_rad == 0) return towards;
  return normalized(rotation_of(towards, tilt_x_rad, tilt_y_rad) * towards);
}

Vec3 turned_about(Vec3 position_m, double tilt_x_rad, double tilt_y_rad, Vec3 centre_m) {
  const Vec3 arm = position_m - centre_m;
  const double length = norm(arm);
  if ((tilt_x_rad == 0 && tilt_y_rad == 0) || length == 0) return position_m;
  return centre_m + turned(arm / length, tilt_x_rad, tilt_y_rad) * length;
}

Vec3 turned_with(Vec3 direction, Vec3 position_m, double tilt_x_rad, double tilt_y_rad, Vec3 centre_m) {
  const Vec3 arm = position_m - centre_m;
  const double length = norm(arm);
  if ((tilt_x_rad == 0 && tilt_y_rad == 0) || length == 0) return direction;
  return rotation_of(arm / length, tilt_x_rad, tilt_y_rad) * direction;
}

}  // namespace gonio::light
