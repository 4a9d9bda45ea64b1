// Li, Wang & Wu 2010: both rotations and both translations as one linear problem of 24 unknowns (eqs. 20 and 21):
// R_A R_X - R_Z R_B = 0 and R_Z t_B + t_Z - R_A t_X = t_A at every sample. Lengths are in units of the motions' size;
// the rotations are projected, and the translations solved once more with the result.
#include "robot/handeye/motions.h"

namespace gonio::robot::handeye {

Solution li(const Motions& motions) {
  Eigen::MatrixXd n = Eigen::MatrixXd::Zero(24, 24);
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(24);
  // The origin of the lengths is the mean place of the mount, so that a far base does not outweigh the rotations.
  Vector3 origin = Vector3::Zero();
  for (const PoseSample& s : motions.samples) {
    origin += eigen_of(s.stand_from_mount.translation_m) / static_cast<double>(motions.samples.size());
  }
  for (const PoseSample& s : motions.samples) {
    const auto board_from_camera = inverse(s.camera_from_board);
    const Matrix3 a = eigen_of(s.stand_from_mount.rotation), b = eigen_of(board_from_camera.rotation);
    const Vector3 t_a = (eigen_of(s.stand_from_mount.translation_m) - origin) / motions.length_m;
    const Vector3 t_b = eigen_of(board_from_camera.translation_m) / motions.length_m;
    Eigen::MatrixXd k = Eigen::MatrixXd::Zero(12, 24);  // R_X, R_Z column by column, t_X, t_Z
    for (int c = 0; c < 3; ++c) {
      k.block<3, 3>(3 * c, 3 * c) = a;
      for (int d = 0; d < 3; ++d) k.block<3, 3>(3 * c, 9 + 3 * d) = -b(d, c) * Matrix3::Identity();
      k.block<3, 3>(9, 9 + 3 * c) = t_b(c) * Matrix3::Identity();
    }
    k.block<3, 3>(9, 18) = -a;
    k.block<3, 3>(9, 21) = Matrix3::Identity();
    n.noalias() += k.transpose() * k;
    rhs.noalias() += k.bottomRows<3>().transpose() * t_a;
  }
  const Eigen::VectorXd x = solve_semidefinite(n, rhs);
  return with_translations(motions, nearest_rotation(Eigen::Map<const Matrix3>(x.data())),
                           nearest_rotation(Eigen::Map<const Matrix3>(x.data() + 9)));
}

}  // namespace gonio::robot::handeye
