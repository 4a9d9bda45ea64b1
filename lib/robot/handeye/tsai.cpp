// Tsai & Lenz 1989: with P = 2 sin(angle / 2) axis of each motion, eq. 12 gives the camera's rotation as a linear
// problem in its Gibbs vector g = tan(angle / 2) axis:  (P_a + P_b) x g = P_b - P_a.  A Gibbs vector is infinite at 180
// degrees; so the camera's axes are first turned by 0 or 180 degrees about one of x, y, z, whichever leaves an angle of
// at most 120 degrees, as one of four always does.
#include "linear/symmetric_eigen.h"
#include "robot/handeye/motions.h"

namespace gonio::robot::handeye {
namespace {

// [P_a + P_b]x g = P_b - P_a, and in homogeneous form, g = v / w, the null vector (w, v) of [P_a - P_b | [P_a + P_b]x].
Eigen::Vector4d homogeneous(const Motions& motions) {
  Eigen::Matrix4d n = Eigen::Matrix4d::Zero();
  for (const Motion& m : motions.pairs) {
    Eigen::Matrix<double, 3, 4> k;
    k << m.a.tail<3>() - m.b.tail<3>(), cross_matrix(m.a.tail<3>() + m.b.tail<3>());
    n.noalias() += k.transpose() * k;
  }
  const linear::SymmetricEigen<Eigen::Matrix4d> e(n);
  return e.eigenvectors().col(0);
}

}  // namespace

Solution tsai(const Motions& motions) {
  Eigen::Index largest = 0;
  homogeneous(motions).cwiseAbs().maxCoeff(&largest);
  // x = y c with c one of 1, i, j, k: the component `largest` of x becomes the scalar part of y, up to its sign.
  const Eigen::Vector4d c = Eigen::Vector4d::Unit(largest);
  const Matrix3 turn = rotation_of(c);
  Matrix3 n = Matrix3::Zero();
  Vector3 rhs = Vector3::Zero();
  for (const Motion& m : motions.pairs) {
    const Vector3 a = 2 * m.a.tail<3>(), b = 2 * (turn * m.b.tail<3>());
    const Matrix3 k = cross_matrix(a + b);
    n.noalias() += k.transpose() * k;
    rhs.noalias() += k.transpose() * (b - a);
  }
  const Eigen::VectorXd g = solve_semidefinite(n, rhs);
  const Matrix3 y = rotation_of({1, g(0), g(1), g(2)});
  return with_board(motions, with_translation(motions, y * turn));
}

}  // namespace gonio::robot::handeye
