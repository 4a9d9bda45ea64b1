// Park & Martin 1994: the logarithms alpha, beta of a motion's rotations in both frames satisfy alpha = R_X beta; the
// least squares solution over all motions is R_X = (M' M)^(-1/2) M' with M = sum beta alpha' (eq. 12), computed by the
// singular value decomposition, which also holds where M has rank two. Logarithms are taken of quaternions with signs
// that agree, so that angles may pass 180 degrees.
#include "robot/handeye/motions.h"

namespace gonio::robot::handeye {
namespace {

Vector3 logarithm(const Eigen::Vector4d& q) {
  const double s = q.tail<3>().norm();
  if (s < 1e-150) return 2 * q.tail<3>();
  return 2 * std::atan2(s, q(0)) / s * q.tail<3>();
}

}  // namespace

Solution park(const Motions& motions) {
  Matrix3 sum = Matrix3::Zero();
  for (const Motion& m : motions.pairs) sum.noalias() += logarithm(m.a) * logarithm(m.b).transpose();
  return with_board(motions, with_translation(motions, nearest_rotation(sum)));
}

}  // namespace gonio::robot::handeye
