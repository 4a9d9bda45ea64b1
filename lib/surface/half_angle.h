// The half-vector coordinates of Rusinkiewicz 1998. Local frame, +z the normal; both directions above the horizon.
//   h = half vector;  theta_h its angle to the normal;  theta_d the angle between h and either direction;
//   phi_d the azimuth of wi about h, from the plane of h and the normal, in [0, pi): wi and wo may be exchanged.
#pragma once
#include <cmath>
#include <utility>

#include "geom/vector.h"

namespace gonio::surface {

struct HalfAngles {
  double theta_h = 0, theta_d = 0, phi_d = 0;
};

inline HalfAngles half_angles(Vec3 wo, Vec3 wi) {
  const Vec3 sum = wo + wi, difference = wi - wo;
  const double across = std::hypot(sum.x, sum.y), length = std::sqrt(across * across + sum.z * sum.z);
  HalfAngles at;
  at.theta_h = std::atan2(across, sum.z);
  at.theta_d = std::atan2(norm(difference), length);
  const Vec2 along = across > 0 ? Vec2{sum.x / across, sum.y / across} : Vec2{1, 0};
  double x = (sum.z * (along.x * difference.x + along.y * difference.y) - across * difference.z);
  double y = length * (along.x * difference.y - along.y * difference.x);
  if (y < 0 || (y == 0 && x < 0)) {
    x = -x;
    y = -y;
  }
  at.phi_d = y == 0 && x == 0 ? 0 : std::atan2(y, x);
  if (at.phi_d >= pi) at.phi_d = 0;
  return at;
}

// wo and wi with the half vector in the plane y = 0, x >= 0.
inline std::pair<Vec3, Vec3> directions_of(const HalfAngles& at) {
  const double ch = std::cos(at.theta_h), sh = std::sin(at.theta_h), cd = std::cos(at.theta_d),
               sd = std::sin(at.theta_d);
  const Vec3 h{sh, 0, ch}, t{ch, 0, -sh}, b{0, 1, 0};
  const Vec3 side = t * (sd * std::cos(at.phi_d)) + b * (sd * std::sin(at.phi_d));
  return {h * cd - side, h * cd + side};
}

}  // namespace gonio::surface
