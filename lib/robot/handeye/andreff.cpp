// Andreff, Horaud & Espiau 1999: rotation and translation together as one linear problem in the nine entries of R_X and
// t_X (eq. 15): R_A R_X - R_X R_B = 0 and R_X t_B - (R_A - 1) t_X = t_A. Lengths are in units of the motions' size;
// without that the paper's rows weigh rotations against metres. The nine numbers are projected on the rotations, and
// the translation is solved once more with the result, as the authors advise.
#include "robot/handeye/motions.h"

namespace gonio::robot::handeye {

Solution andreff(const Motions& motions) {
  using Row = Eigen::Matrix<double, 12, 12>;
  Eigen::MatrixXd n = Eigen::MatrixXd::Zero(12, 12);
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(12);
  for (const Motion& m : motions.pairs) {
    Row k = Row::Zero();  // unknowns: R_X column by column, t_X
    for (int c = 0; c < 3; ++c) {
      k.block<3, 3>(3 * c, 3 * c) += m.rotation_a;
      for (int d = 0; d < 3; ++d) k.block<3, 3>(3 * c, 3 * d) -= m.rotation_b(d, c) * Matrix3::Identity();
      k.block<3, 3>(9, 3 * c) = m.shift_b(c) * Matrix3::Identity();
    }
    k.block<3, 3>(9, 9) = Matrix3::Identity() - m.rotation_a;
    n.noalias() += k.transpose() * k;
    rhs.noalias() += k.block<3, 12>(9, 0).transpose() * m.shift_a;
  }
  const Eigen::VectorXd x = solve_semidefinite(n, rhs);
  return with_board(motions, with_translation(motions, nearest_rotation(Eigen::Map<const Matrix3>(x.data()))));
}

}  // namespace gonio::robot::handeye
