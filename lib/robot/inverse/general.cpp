// See general.h. With G p = W zero^-1 the motion of the flange since all joints were zero, l = h6 and p = o6 (which
// joint 6 does not move), lengths over the arm's size, positions from a point of axis 3:
//
//   E3 E4 E5 (p, l) = E2^-1 E1^-1 G (p, l)
//
// and for both sides alike l, p, p.p, p.l, p x l, (p.p) l - 2 (p.l) p: 14 equations, left in joints 3, 4, 5, right in
// 1, 2.
#include "robot/inverse/general.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <complex>

#include "linear/general_eigen.h"
#include "linear/qr.h"
#include "robot/inverse/closed_form_parts.h"

namespace gonio::robot::general {
namespace {

using screws::Pose;
using screws::turned;
using Fourteen = Eigen::Matrix<double, 14, 1>;
using Left = std::array<Eigen::Matrix<double, 14, 9>, 3>;  // factors of 1, cos q3, sin q3
using Right = Eigen::Matrix<double, 14, 9>;                // columns (1, c, s) x (1, c, s), the later joint faster

Fourteen equations(Vec3 p, Vec3 l) {
  const double pp = dot(p, p), pl = dot(p, l);
  const Vec3 pxl = cross(p, l), last = l * pp - p * (2 * pl);
  Fourteen e;
  e << l.x, l.y, l.z, p.x, p.y, p.z, pp, pl, pxl.x, pxl.y, pxl.z, last.x, last.y, last.z;
  return e;
}

Vec3 moved(Vec3 axis, Vec3 through, double angle_rad, Vec3 point) {
  return through + turned(axis, angle_rad) * (point - through);
}

constexpr double third_turn = 2 * pi / 3;

// From values at 0, 120 and 240 degrees the factors of 1, cos, sin.
Eigen::Matrix3d interpolation() {
  Eigen::Matrix3d m;
  for (int k = 0; k < 3; ++k)
    m.col(k) << 1.0 / 3, 2.0 / 3 * std::cos(third_turn * k), 2.0 / 3 * std::sin(third_turn * k);
  return m;
}

// What joint 3's, 4's and 5's angles are counted from: with the tangent of half an angle, pi is infinitely far.
using Origins = std::array<double, 3>;

Left left_of(const screws::Screws& s, const Origins& from) {
  const Eigen::Matrix3d to = interpolation();
  Left left{};
  for (auto& l : left) l.setZero();
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      for (int c = 0; c < 3; ++c) {
        Vec3 p = s.point_m[5], l = s.axis[5];
        const std::array<double, 3> q = {from[0] + third_turn * a, from[1] + third_turn * b, from[2] + third_turn * c};
        for (std::size_t i = 5; i-- > 2;)
          p = moved(s.axis[i], s.point_m[i], q[i - 2], p), l = turned(s.axis[i], q[i - 2]) * l;
        const Fourteen e = equations(p - s.point_m[2], l);
        for (int k = 0; k < 27; ++k)
          left[static_cast<std::size_t>(k / 9)].col(k % 9) += e * (to(k / 9, a) * to(k / 3 % 3, b) * to(k % 3, c));
      }
  return left;
}

Right right_of(const screws::Screws& s, const Pose& moved_by) {
  const Eigen::Matrix3d to = interpolation();
  Right right = Right::Zero();
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      Vec3 p = moved_by.position_m + moved_by.rotation * s.point_m[5], l = moved_by.rotation * s.axis[5];
      p = moved(s.axis[0], s.point_m[0], -third_turn * a, p), l = turned(s.axis[0], -third_turn * a) * l;
      p = moved(s.axis[1], s.point_m[1], -third_turn * b, p), l = turned(s.axis[1], -third_turn * b) * l;
      const Fourteen e = equations(p - s.point_m[2], l);
      for (int k = 0; k < 9; ++k) right.col(k) += e * (to(k / 3, a) * to(k % 3, b));
    }
  return right;
}

// (1, c, s) x (1, c, s) times (1 + x^2)(1 + y^2) in 1, y, y^2, x, ... x^2 y^2.
Eigen::Matrix<double, 9, 9> powers() {
  Eigen::Matrix3d one;  // column: 1, cos, sin; row: power of the tangent
  one << 1, 1, 0, 0, 0, 2, 1, -1, 0;
  Eigen::Matrix<double, 9, 9> both;
  for (int r = 0; r < 9; ++r)
    for (int c = 0; c < 9; ++c) both(r, c) = one(r / 3, c / 3) * one(r % 3, c % 3);
  return both;
}

using Twelve = Eigen::Matrix<double, 12, 12>;

// Six equations, and the same times x: 12 in the powers x^0..3 y^0..2.
Twelve twice(const Eigen::Matrix<double, 6, 9>& six) {
  static const Eigen::Matrix<double, 9, 9> to = powers().transpose();
  const Eigen::Matrix<double, 6, 9> in_powers = six * to;
  Twelve m = Twelve::Zero();
  m.topLeftCorner<6, 9>() = in_powers;
  m.bottomRightCorner<6, 9>() = in_powers;
  return m;
}

// v[later] / v[earlier], as one number for all pairs.
std::complex<double> ratio(const Eigen::VectorXcd& v, bool of_x) {
  std::complex<double> sum = 0;
  double square = 0;
  for (int i = 0; i < 12; ++i) {
    const int next = of_x ? i + 3 : i + 1;
    if (next >= 12 || (!of_x && i % 3 == 2)) continue;
    sum += std::conj(v[i]) * v[next];
    square += std::norm(v[i]);
  }
  return sum / square;
}

struct Root {
  double q3 = 0, q4 = 0, q5 = 0;
  double imaginary = 0;  // how far from real: of the half angle
};

}  // namespace

struct AllRoots::Parts {
  screws::Screws arm;  // lengths over its size
  double size_m = 1;
  std::array<Origins, 2> origins{{{0.37, -0.81, 1.13}, {-1.9, 2.3, -2.6}}};
  std::array<Left, 2> left;

  std::vector<Root> roots(const Right& right, std::size_t which) const;
  Joints completed(const Root& root, const Pose& moved_by, const linear::LeastNorm& outer, const Right& right) const;
};

AllRoots::AllRoots(const screws::Screws& screws) {
  auto parts = std::make_unique<Parts>();
  parts->arm = screws;
  parts->size_m = screws.size_m;
  for (Vec3& p : parts->arm.point_m) p = p / screws.size_m;
  parts->arm.zero.position_m = screws.zero.position_m / screws.size_m;
  for (std::size_t i = 0; i < 2; ++i) parts->left[i] = left_of(parts->arm, parts->origins[i]);
  parts_ = std::move(parts);
}
AllRoots::~AllRoots() = default;
AllRoots::AllRoots(AllRoots&&) noexcept = default;
AllRoots& AllRoots::operator=(AllRoots&&) noexcept = default;

std::vector<Root> AllRoots::Parts::roots(const Right& right, std::size_t which) const {
  // Combinations of the equations in which joints 1 and 2 cancel.
  const Eigen::MatrixXd cancel = linear::PivotedQr(right.rightCols<8>()).orthonormal(14).rightCols(6).transpose();
  std::array<Eigen::Matrix<double, 6, 9>, 3> six;
  for (std::size_t k = 0; k < 3; ++k) six[k] = cancel * left[which][k];
  six[0].col(0) -= cancel * right.col(0);
  // (1 + z^2) (f0 + f1 cos q3 + f2 sin q3) = z^2 (f0 - f1) + 2 z f2 + f0 + f1
  const Twelve a = twice(six[0] - six[1]), b = twice(2 * six[2]), c = twice(six[0] + six[1]);
  const linear::PivotedQr leading(a);
  Eigen::MatrixXd companion = Eigen::MatrixXd::Zero(24, 24);
  companion.topRightCorner(12, 12).setIdentity();
  companion.bottomLeftCorner(12, 12) = -leading.solve(Eigen::MatrixXd(c));
  companion.bottomRightCorner(12, 12) = -leading.solve(Eigen::MatrixXd(b));
  const linear::GeneralEigen eigen(companion);
  std::vector<Root> found;
  if (eigen.info() != Eigen::Success) return found;
  const Origins& from = origins[which];
  for (int i = 0; i < 24; ++i) {
    const std::complex<double> z = eigen.values()[i];
    if (z.imag() < 0 || std::abs(z - std::complex<double>(0, 1)) < 1e-2) continue;  // conjugates; (1 + z^2)^4
    const Eigen::VectorXcd v = eigen.vectors().col(i);
    const Eigen::VectorXcd half = std::abs(z) > 1 ? v.tail(12) : v.head(12);
    const std::complex<double> x = ratio(half, true), y = ratio(half, false);
    found.push_back({from[0] + 2 * std::atan(z).real(), from[1] + 2 * std::atan(x).real(),
                     from[2] + 2 * std::atan(y).real(), std::abs(std::atan(z).imag())});
  }
  return found;
}

Joints AllRoots::Parts::completed(const Root& root, const Pose& moved_by, const linear::LeastNorm& outer,
                                  const Right& right) const {
  Joints q{0, 0, root.q3, root.q4, root.q5, 0};
  Vec3 p = arm.point_m[5], l = arm.axis[5];
  for (std::size_t i = 5; i-- > 2;) p = moved(arm.axis[i], arm.point_m[i], q[i], p), l = turned(arm.axis[i], q[i]) * l;
  const Fourteen rest = equations(p - arm.point_m[2], l) - right.col(0);
  const Eigen::VectorXd m = outer.solve(Eigen::VectorXd(rest));  // c2 s2 c1 c1c2 c1s2 s1 s1c2 s1s2
  q[0] = std::atan2(m[5], m[2]), q[1] = std::atan2(m[1], m[0]);
  Mat3 turn = moved_by.rotation;
  for (std::size_t i = 0; i < 5; ++i) turn = turned(arm.axis[i], -q[i]) * turn;
  q[5] = closed_form::angle_about(arm.axis[5], turn);
  return q;
}

std::vector<Joints> AllRoots::starts(const Pose& wanted) const {
  const auto& s = parts_->arm;
  const Pose scaled{wanted.rotation, wanted.position_m / parts_->size_m};
  const Pose moved_by = scaled * screws::inverse(s.zero);
  const Right right = right_of(s, moved_by);
  const linear::LeastNorm outer(right.rightCols<8>());
  std::vector<Joints> real, other;
  for (std::size_t which = 0; which < 2; ++which)
    for (const Root& root : parts_->roots(right, which))
      (root.imaginary < 0.02 ? real : other).push_back(parts_->completed(root, moved_by, outer, right));
  return real.empty() ? other : real;
}

}  // namespace gonio::robot::general
