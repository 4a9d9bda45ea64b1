#include "linear/symmetric_eigen.h"

#include <Eigen/Eigenvalues>
#include <type_traits>

namespace gonio::linear {

template <class Matrix>
SymmetricEigen<Matrix>::SymmetricEigen(const Matrix& a, int what) {
  // Two and three rows have ways of their own; between the others the size makes no difference worth compiling.
  using Solved =
      std::conditional_t<Matrix::RowsAtCompileTime == 2 || Matrix::RowsAtCompileTime == 3, Matrix, Eigen::MatrixXd>;
  const Eigen::SelfAdjointEigenSolver<Solved> solver(a, what);
  info_ = solver.info();
  values_ = solver.eigenvalues();
  if (what == Eigen::ComputeEigenvectors) vectors_ = solver.eigenvectors();
}

template class SymmetricEigen<Eigen::MatrixXd>;
template class SymmetricEigen<Eigen::Matrix2d>;
template class SymmetricEigen<Eigen::Matrix3d>;
template class SymmetricEigen<Eigen::Matrix4d>;
template class SymmetricEigen<Eigen::Matrix<double, 6, 6>>;
template class SymmetricEigen<Eigen::Matrix<double, 8, 8>>;
template class SymmetricEigen<Eigen::Matrix<double, 9, 9>>;
template class SymmetricEigen<Eigen::Matrix<double, 12, 12>>;

}  // namespace gonio::linear
