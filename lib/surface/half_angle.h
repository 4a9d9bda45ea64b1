// The half-vector coordinates of Rusinkiewicz 1998. Local frame, +z the normal; both directions above the horizon.
//   h = half vector;  theta_h its angle to the normal;  theta_d the angle between h and either direction;
//   phi_d the azimuth of wi about h, from the plane of h and the normal, in [0, pi): wi and wo may be exchanged.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "geom/vector.h"

namespace gonio::surface {

// The angle of (x, y) for y >= 0, in [0, pi], in a quarter of atan2's time: with r = min / max and the nearest
// tabulated r_i, atan r = atan r_i + atan t, t = (r - r_i) / (1 + r r_i), |t| < 1 / 128. 0 at the origin. Error below
// 1e-15.
inline double arc(double y, double x) {
  constexpr int steps = 64;
  static const std::array<double, steps + 1> known = [] {
    std::array<double, steps + 1> angles{};
    for (std::size_t i = 0; i <= steps; ++i) angles[i] = std::atan(static_cast<double>(i) / steps);
    return angles;
  }();
  const double across = std::abs(x), least = std::min(across, y), most = std::max(across, y);
  if (!(most > 0)) return 0;
  const double r = least / most;
  const auto i = static_cast<std::size_t>(r * steps + 0.5);
  const double near = static_cast<double>(i) / steps, t = (r - near) / (1 + r * near), t2 = t * t;
  double angle = known[i] + t * (1 - t2 * (1 / 3.0 - t2 / 5));
  if (y > across) angle = pi / 2 - angle;
  return x < 0 ? pi - angle : angle;
}

struct HalfAngles {
  double theta_h = 0, theta_d = 0, phi_d = 0;
};

inline HalfAngles half_angles(Vec3 wo, Vec3 wi) {
  const Vec3 sum = wo + wi, difference = wi - wo;
  const double across2 = sum.x * sum.x + sum.y * sum.y, across = std::sqrt(across2),
               length = std::sqrt(across2 + sum.z * sum.z);
  HalfAngles at;
  at.theta_h = arc(across, sum.z);
  at.theta_d = arc(norm(difference), length);
  const Vec2 along = across > 0 ? Vec2{sum.x / across, sum.y / across} : Vec2{1, 0};
  double x = (sum.z * (along.x * difference.x + along.y * difference.y) - across * difference.z);
  double y = length * (along.x * difference.y - along.y * difference.x);
  if (y < 0 || (y == 0 && x < 0)) {
    x = -x;
    y = -y;
  }
  at.phi_d = arc(y, x);
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
