// Eigenvalues and eigenvectors of symmetric matrices: A = V diag(w) V', w ascending, columns of V orthonormal. Only the
// lower triangle of A is read. Eigen's SelfAdjointEigenSolver (implicit symmetric QR, Golub & Van Loan, Matrix
// Computations, 8.3), which takes six seconds to compile in every source that names it, compiled once.
//
// Matrix is Eigen::MatrixXd or Eigen::Matrix<double, N, N> with N = 2, 3, 4, 6, 8, 9, 12 (symmetric_eigen.cpp lists
// them; another size is one line there, until then the linker misses it).
#pragma once
#include <Eigen/Core>

namespace gonio::linear {

template <class Matrix>
class SymmetricEigen {
 public:
  using Vector = Eigen::Matrix<double, Matrix::RowsAtCompileTime, 1>;

  SymmetricEigen() = default;
  // `what`: Eigen::ComputeEigenvectors, or Eigen::EigenvaluesOnly (eigenvectors() is empty or undefined then).
  explicit SymmetricEigen(const Matrix& a, int what = Eigen::ComputeEigenvectors);

  const Vector& eigenvalues() const { return values_; }
  const Matrix& eigenvectors() const { return vectors_; }
  Eigen::ComputationInfo info() const { return info_; }  // Success, or NoConvergence (NaN in, for one)

 private:
  Vector values_;
  Matrix vectors_;
  Eigen::ComputationInfo info_ = Eigen::InvalidInput;
};

}  // namespace gonio::linear
