// Singular value decompositions A = U diag(s) V', s descending; options as Eigen names them (ComputeThinU,
// ComputeFullV, ...; what was not asked for stays empty). JacobiSvd: two-sided Jacobi, the most accurate and right for
// small matrices; DividedSvd: divide and conquer, for large ones. Eigen's JacobiSVD and BDCSVD (8 and 27 seconds to
// compile in every source that names them), compiled once.
//
// JacobiSvd: Eigen::MatrixXd or Eigen::Matrix<double, N, N> with N = 2, 3, 9 (svd.cpp lists them).
#pragma once
#include <Eigen/Core>

namespace gonio::linear {

template <class Matrix>
class JacobiSvd {
 public:
  using Vector = Eigen::Matrix<double, Matrix::RowsAtCompileTime, 1>;

  explicit JacobiSvd(const Matrix& a, unsigned options = 0);
  const Matrix& matrixU() const { return u_; }
  const Matrix& matrixV() const { return v_; }
  const Vector& singularValues() const { return values_; }

 private:
  Matrix u_, v_;
  Vector values_;
};

class DividedSvd {
 public:
  explicit DividedSvd(const Eigen::MatrixXd& a, unsigned options = 0);
  const Eigen::MatrixXd& matrixU() const { return u_; }
  const Eigen::MatrixXd& matrixV() const { return v_; }
  const Eigen::VectorXd& singularValues() const { return values_; }

 private:
  Eigen::MatrixXd u_, v_;
  Eigen::VectorXd values_;
};

}  // namespace gonio::linear
