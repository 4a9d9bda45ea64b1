// Eigenvalues and eigenvectors of matrices that need not be symmetric: A v = w v, w and v complex. Eigen's EigenSolver
// (Hessenberg form, then the QR algorithm with double shifts; Golub & Van Loan, Matrix Computations, 7.5), compiled
// once.
#pragma once
#include <Eigen/Core>
#include <complex>

namespace gonio::linear {

class GeneralEigen {
 public:
  explicit GeneralEigen(const Eigen::MatrixXd& square);
  const Eigen::VectorXcd& values() const { return values_; }
  const Eigen::MatrixXcd& vectors() const { return vectors_; }  // one a column, of length 1
  Eigen::ComputationInfo info() const { return info_; }         // Success, or NoConvergence: nothing above holds

 private:
  Eigen::VectorXcd values_;
  Eigen::MatrixXcd vectors_;
  Eigen::ComputationInfo info_;
};

}  // namespace gonio::linear
