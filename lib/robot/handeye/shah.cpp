// Shah 2013: R_A R_X = R_Z R_B means (R_B x R_A) vec R_X = vec R_Z at every sample; the sum of these 9 x 9 matrices has
// vec R_X and vec R_Z as its first right and left singular vectors (eqs. 17 to 22), each up to a factor whose sign the
// determinant gives. Both translations follow by linear least squares.
#include "linear/svd.h"
#include "robot/handeye/motions.h"

namespace gonio::robot::handeye {

Solution shah(const Motions& motions) {
  using Matrix9 = Eigen::Matrix<double, 9, 9>;
  Matrix9 sum = Matrix9::Zero();
  for (const PoseSample& s : motions.samples) {
    const Matrix3 a = eigen_of(s.stand_from_mount.rotation), b = eigen_of(s.camera_from_board.rotation).transpose();
    for (int r = 0; r < 3; ++r) {
      for (int c = 0; c < 3; ++c) sum.block<3, 3>(3 * r, 3 * c) += b(r, c) * a;
    }
  }
  const linear::JacobiSvd<Matrix9> svd(sum, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const Eigen::Matrix<double, 9, 1> x = svd.matrixV().col(0), z = svd.matrixU().col(0);
  return with_translations(motions, rotation_in_multiple(Eigen::Map<const Matrix3>(x.data())),
                           rotation_in_multiple(Eigen::Map<const Matrix3>(z.data())));
}

}  // namespace gonio::robot::handeye
