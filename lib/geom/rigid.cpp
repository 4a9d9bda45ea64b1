// Unit quaternions, rotation matrices and rotation vectors.
// Conversions from a matrix follow Shepperd 1978, "Quaternion from Rotation Matrix": the largest of w, x, y, z is found
// first and divides the others, so that none loses its digits near 0 or pi.
#include "geom/rigid.h"

#include <algorithm>
#include <cmath>

namespace gonio {

Quaternion operator*(const Quaternion& a, const Quaternion& b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}

Quaternion conjugate(const Quaternion& q) {
  return {q.w, -q.x, -q.y, -q.z};
}

Quaternion normalized(const Quaternion& q) {
  const double length = std::sqrt(q.w * q.w + q.x * q.x + q.y * q.y + q.z * q.z);
  return {q.w / length, q.x / length, q.y / length, q.z / length};
}

Mat3 matrix_of(const Quaternion& q) {
  const double xx = q.x * q.x, yy = q.y * q.y, zz = q.z * q.z;
  const double xy = q.x * q.y, xz = q.x * q.z, yz = q.y * q.z;
  const double wx = q.w * q.x, wy = q.w * q.y, wz = q.w * q.z;
  return {{1 - 2 * (yy + zz), 2 * (xy - wz), 2 * (xz + wy),  //
           2 * (xy + wz), 1 - 2 * (xx + zz), 2 * (yz - wx),  //
           2 * (xz - wy), 2 * (yz + wx), 1 - 2 * (xx + yy)}};
}

Quaternion quaternion_of(const Mat3& r) {
  // Four times the squares of w, x, y, z.
  const std::array<double, 4> square = {1 + r(0, 0) + r(1, 1) + r(2, 2), 1 + r(0, 0) - r(1, 1) - r(2, 2),
                                        1 - r(0, 0) + r(1, 1) - r(2, 2), 1 - r(0, 0) - r(1, 1) + r(2, 2)};
  const auto largest = std::max_element(square.begin(), square.end()) - square.begin();
  const double wx = r(2, 1) - r(1, 2), wy = r(0, 2) - r(2, 0), wz = r(1, 0) - r(0, 1);  // four times w x, w y, w z
  const double xy = r(0, 1) + r(1, 0), xz = r(0, 2) + r(2, 0), yz = r(1, 2) + r(2, 1);
  Quaternion q;
  if (largest == 0) q = {square[0], wx, wy, wz};
  if (largest == 1) q = {wx, square[1], xy, xz};
  if (largest == 2) q = {wy, xy, square[2], yz};
  if (largest == 3) q = {wz, xz, yz, square[3]};
  q = normalized(q);
  return q.w < 0 ? Quaternion{-q.w, -q.x, -q.y, -q.z} : q;
}

Quaternion quaternion_of_rotation_vector(Vec3 v) {
  const double angle = norm(v);
  // sin(a / 2) / a, by its series where a^4 / 1920 is below the last digit of 1 / 2.
  const double scale = angle < 1e-4 ? 0.5 - angle * angle / 48 : std::sin(angle / 2) / angle;
  return normalized({std::cos(angle / 2), v.x * scale, v.y * scale, v.z * scale});
}

Vec3 rotation_vector_of(const Quaternion& q) {
  const double sign = q.w < 0 ? -1.0 : 1.0;  // q and -q are one rotation; the one with w >= 0 turns by at most pi
  const Vec3 v = Vec3{q.x, q.y, q.z} * sign;
  const double s = norm(v);
  if (s < 1e-150) return v * 2.0;
  return v * (2 * std::atan2(s, sign * q.w) / s);
}

}  // namespace gonio
