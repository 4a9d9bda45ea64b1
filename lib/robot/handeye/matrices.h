// Rigid motions as Eigen matrices, and the projections onto rotations that the solvers share. For sources of this
// folder only.
#pragma once
#include <Eigen/Core>
#include <Eigen/LU>

#include "geom/rigid.h"
#include "linear/geom_matrices.h"
#include "linear/svd.h"
#include "linear/symmetric_eigen.h"

namespace gonio::robot::handeye {

using Matrix3 = Eigen::Matrix3d;
using Vector3 = Eigen::Vector3d;

using linear::cross_matrix;
inline Vector3 eigen_of(Vec3 v) {
  return linear::as_eigen(v);
}
inline Vec3 vec_of(const Vector3& v) {
  return {v.x(), v.y(), v.z()};
}
inline Matrix3 eigen_of(const Quaternion& q) {
  return linear::as_eigen(matrix_of(q));
}
inline Quaternion quaternion_from(const Matrix3& rotation) {
  return quaternion_of(linear::mat3_of(rotation));
}
// The rotation that maximises trace(R' m): Arun, Huang & Blostein, PAMI 9(5), 1987, with Umeyama's sign (PAMI 13(4),
// 1991).
inline Matrix3 nearest_rotation(const Matrix3& m) {
  const linear::JacobiSvd<Matrix3> svd(m, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const double sign = (svd.matrixU() * svd.matrixV().transpose()).determinant() < 0 ? -1 : 1;
  return svd.matrixU() * Vector3(1, 1, sign).asDiagonal() * svd.matrixV().transpose();
}
// The rotation in a multiple of a rotation matrix, whose factor may be negative.
inline Matrix3 rotation_in_multiple(const Matrix3& m) {
  return nearest_rotation(m.determinant() < 0 ? Matrix3(-m) : m);
}

// Solution of n x = b for a symmetric, positive semidefinite n: along directions whose eigenvalue is below `share` of
// the largest, x is zero.
inline Eigen::VectorXd solve_semidefinite(const Eigen::MatrixXd& n, const Eigen::VectorXd& b, double share = 1e-13) {
  const linear::SymmetricEigen<Eigen::MatrixXd> e(n);
  Eigen::VectorXd y = e.eigenvectors().transpose() * b;
  const double limit = share * e.eigenvalues().cwiseAbs().maxCoeff();
  for (Eigen::Index i = 0; i < y.size(); ++i) y(i) = e.eigenvalues()(i) > limit ? y(i) / e.eigenvalues()(i) : 0;
  return e.eigenvectors() * y;
}

}  // namespace gonio::robot::handeye
