// Horaud & Dornaika 1995, section 4.1: the camera's rotation as the unit quaternion x that minimises
// sum |v_a x - x v_b|^2, the eigenvector of the smallest eigenvalue of a symmetric 4 x 4 matrix (eqs. 25 to 29). The
// paper takes the motions' axes as unit vectors; here they have the length sin(angle / 2), so that the axis of a small
// rotation, which noise turns at will, counts for little.
#include "linear/symmetric_eigen.h"
#include "robot/handeye/motions.h"

namespace gonio::robot::handeye {

Solution horaud(const Motions& motions) {
  Eigen::Matrix4d n = Eigen::Matrix4d::Zero();
  for (const Motion& m : motions.pairs) {
    Eigen::Vector4d a = m.a, b = m.b;
    a(0) = b(0) = 0;
    const Eigen::Matrix4d k = left_product(a) - right_product(b);
    n.noalias() += k.transpose() * k;
  }
  const linear::SymmetricEigen<Eigen::Matrix4d> e(n);
  return with_board(motions, with_translation(motions, rotation_of(e.eigenvectors().col(0))));
}

}  // namespace gonio::robot::handeye
