// Daniilidis 1999: motions as unit dual quaternions a + e a', b + e b'; a x = x b becomes six homogeneous equations a
// motion in the eight numbers of the camera's dual quaternion (eq. 31), which lies in the plane of the two smallest
// singular vectors; unit length and orthogonality of its two parts (eqs. 34 and 35) leave one quadratic equation.
#include <cmath>

#include "linear/symmetric_eigen.h"
#include "robot/handeye/motions.h"

namespace gonio::robot::handeye {
namespace {

Eigen::Vector4d dual_part(const Eigen::Vector4d& q, const Vector3& shift) {
  return 0.5 * left_product({0, shift.x(), shift.y(), shift.z()}) * q;
}

Eigen::Matrix<double, 6, 8> equations(const Motion& m) {
  const Vector3 a = m.a.tail<3>(), b = m.b.tail<3>();
  const Vector3 da = dual_part(m.a, m.shift_a).tail<3>(), db = dual_part(m.b, m.shift_b).tail<3>();
  Eigen::Matrix<double, 6, 8> t = Eigen::Matrix<double, 6, 8>::Zero();
  t.block<3, 1>(0, 0) = a - b;
  t.block<3, 3>(0, 1) = cross_matrix(a + b);
  t.block<3, 1>(3, 0) = da - db;
  t.block<3, 3>(3, 1) = cross_matrix(da + db);
  t.block<3, 4>(3, 4) = t.block<3, 4>(0, 0);
  return t;
}

}  // namespace

Solution daniilidis(const Motions& motions) {
  Eigen::Matrix<double, 8, 8> n = Eigen::Matrix<double, 8, 8>::Zero();
  for (const Motion& m : motions.pairs) {
    const auto t = equations(m);
    n.noalias() += t.transpose() * t;
  }
  const linear::SymmetricEigen<Eigen::Matrix<double, 8, 8>> e(n);
  const Eigen::Vector4d u1 = e.eigenvectors().col(0).head<4>(), v1 = e.eigenvectors().col(0).tail<4>();
  const Eigen::Vector4d u2 = e.eigenvectors().col(1).head<4>(), v2 = e.eigenvectors().col(1).tail<4>();
  // (l1 u1 + l2 u2) . (l1 v1 + l2 v2) = 0; of the two ratios that one which leaves the longer real part. Ratios are
  // taken as angles, so that none is infinite.
  const double p = u1.dot(v1), q = u1.dot(v2) + u2.dot(v1), r = u2.dot(v2);
  // p cos^2 + q cos sin + r sin^2 = 0  <=>  (p - r) cos 2f + q sin 2f = -(p + r).
  const double size = std::hypot(p - r, q), middle = std::atan2(q, p - r);
  const double half = std::acos(size > 0 ? std::min(1.0, std::max(-1.0, -(p + r) / size)) : 0.0);
  Eigen::Vector4d best = Eigen::Vector4d::Unit(0), best_dual = Eigen::Vector4d::Zero();
  double longest = 0;
  for (const double f : {(middle + half) / 2, (middle - half) / 2}) {
    const Eigen::Vector4d real = std::cos(f) * u1 + std::sin(f) * u2, dual = std::cos(f) * v1 + std::sin(f) * v2;
    if (real.norm() <= longest) continue;
    longest = real.norm();
    best = real / longest;
    best_dual = dual / longest;
  }
  const Eigen::Vector4d conjugate(best(0), -best(1), -best(2), -best(3));
  const Eigen::Vector4d shift = 2 * right_product(conjugate) * best_dual;
  return with_board(motions, {quaternion_from(rotation_of(best)), vec_of(shift.tail<3>() * motions.length_m)});
}

}  // namespace gonio::robot::handeye
