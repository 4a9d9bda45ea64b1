// See screws.h.
#include "robot/inverse/screws.h"

#include <cmath>

namespace gonio::robot::screws {

Pose operator*(const Pose& a, const Pose& b) {
  return {a.rotation * b.rotation, a.position_m + a.rotation * b.position_m};
}

Pose inverse(const Pose& a) {
  const Mat3 back = transposed(a.rotation);
  return {back, -(back * a.position_m)};
}

Pose pose_of(const Rigid<frame::Base, frame::Tool>& rigid) {
  return {matrix_of(normalized(rigid.rotation)), rigid.translation_m};
}

Mat3 turned(Vec3 k, double angle_rad) {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  const Vec3 v = k * (1 - c);
  return {{c + v.x * k.x, v.x * k.y - s * k.z, v.x * k.z + s * k.y, v.y * k.x + s * k.z, c + v.y * k.y,
           v.y * k.z - s * k.x, v.z * k.x - s * k.y, v.z * k.y + s * k.x, c + v.z * k.z}};
}

double wrapped(double angle_rad) {
  const double w = std::remainder(angle_rad, 2 * pi);
  return w <= -pi ? w + 2 * pi : w;
}

Screws screws_of(std::span<const Link> six_links) {
  const Joints zero{};
  Screws s;
  for (std::size_t i = 0; i < 6; ++i) {
    const auto before = flange(six_links.first(i), std::span(zero).first(i));
    s.axis[i] = normalized(before.rotate({0, 0, 1}));
    s.point_m[i] = before.translation_m;
    if (i > 0) s.point_m[i] += s.axis[i] * dot(s.axis[i], s.point_m[i - 1] - s.point_m[i]);
  }
  s.zero = pose_of(flange(six_links, zero));
  for (std::size_t i = 0; i < 6; ++i) s.size_m += norm((i < 5 ? s.point_m[i + 1] : s.zero.position_m) - s.point_m[i]);
  return s;
}

Screws reversed(const Screws& screws) {
  // (E_1 .. E_6 M)^-1 = M^-1 E_6^-1 .. E_1^-1 = (E'_6 .. E'_1) M^-1 with E'_i = M^-1 E_i^-1 M: the turn by q_i about
  // minus the axis, seen from the flange.
  const Pose back = inverse(screws.zero);
  Screws s;
  for (std::size_t i = 0; i < 6; ++i) {
    s.axis[i] = -(back.rotation * screws.axis[5 - i]);
    s.point_m[i] = back.position_m + back.rotation * screws.point_m[5 - i];
  }
  s.zero = back;
  s.size_m = screws.size_m;
  return s;
}

Pose flange_at(const Screws& screws, const Joints& joints_rad) {
  Pose pose = screws.zero;
  for (std::size_t i = 6; i-- > 0;) {
    const Mat3 turn = turned(screws.axis[i], joints_rad[i]);
    pose = {turn * pose.rotation, screws.point_m[i] + turn * (pose.position_m - screws.point_m[i])};
  }
  return pose;
}

Motions motions_at(const Screws& screws, const Joints& joints_rad) {
  Motions m;
  Pose before;  // E_1 .. E_{i-1}
  std::array<Vec3, 6> through;
  for (std::size_t i = 0; i < 6; ++i) {
    m.axis[i] = before.rotation * screws.axis[i];
    through[i] = before.position_m + before.rotation * screws.point_m[i];
    const Mat3 turn = turned(screws.axis[i], joints_rad[i]);
    before = before * Pose{turn, screws.point_m[i] - turn * screws.point_m[i]};
  }
  m.flange = before * screws.zero;
  for (std::size_t i = 0; i < 6; ++i) m.shift[i] = cross(m.axis[i], m.flange.position_m - through[i]);
  return m;
}

Miss miss_of(const Pose& is, const Pose& wanted) {
  const Mat3 d = wanted.rotation * transposed(is.rotation);
  const Vec3 twice_sine{d(2, 1) - d(1, 2), d(0, 2) - d(2, 0), d(1, 0) - d(0, 1)};
  const double trace = d(0, 0) + d(1, 1) + d(2, 2), sine = norm(twice_sine) / 2;
  const Vec3 position = wanted.position_m - is.position_m;
  // Small turns: the vector is linear in the matrix, to 1e-16. Others through the quaternion, which is right up to pi.
  if (trace > 2 && sine < 1e-4) return {position, twice_sine * (0.5 * (1 + sine * sine / 6))};
  return {position, rotation_vector_of(quaternion_of(d))};
}

}  // namespace gonio::robot::screws
