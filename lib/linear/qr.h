// Householder QR factorizations of matrices of any size, each Eigen's class of the like name, compiled once.
#pragma once
#include <Eigen/Core>
#include <memory>

namespace gonio::linear {

// A = Q R without pivoting, rows >= columns.
class HouseholderQr {
 public:
  HouseholderQr() = default;
  explicit HouseholderQr(const Eigen::MatrixXd& a);
  const Eigen::MatrixXd& thin_q() const { return q_; }     // rows x columns, orthonormal columns
  const Eigen::MatrixXd& upper() const { return upper_; }  // columns x columns, zero below the diagonal

 private:
  Eigen::MatrixXd q_, upper_;
};

// A P = Q R with column pivoting: rank, and least squares that set to zero what the rank leaves open.
class PivotedQr {
 public:
  explicit PivotedQr(const Eigen::MatrixXd& a);
  // Columns count towards the rank whose pivot exceeds `threshold` times the largest.
  PivotedQr(const Eigen::MatrixXd& a, double threshold);
  Eigen::Index rank() const;
  // rows of b x 1, or rows x columns of b.
  template <class B>
  auto solve(const Eigen::MatrixBase<B>& b) const {
    if constexpr (B::ColsAtCompileTime == 1)
      return solve_one(b);
    else
      return solve_all(b);
  }
  Eigen::MatrixXd orthonormal(Eigen::Index columns) const;  // the first columns of Q
  template <class V>
  Eigen::Matrix<double, Eigen::Dynamic, V::ColsAtCompileTime> turned(const Eigen::MatrixBase<V>& v) const {  // Q' v
    return all_turned(v);
  }

 private:
  struct Factors;
  Eigen::MatrixXd solve_all(const Eigen::MatrixXd& b) const;
  Eigen::VectorXd solve_one(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd all_turned(const Eigen::MatrixXd& v) const;
  std::shared_ptr<const Factors> factors_;
};

// A P = Q [T 0; 0 0] Z (complete orthogonal decomposition): of all least-squares solutions the shortest.
class LeastNorm {
 public:
  explicit LeastNorm(const Eigen::MatrixXd& a);
  Eigen::Index rank() const;
  // rows of b x 1, or rows x columns of b.
  template <class B>
  auto solve(const Eigen::MatrixBase<B>& b) const {
    if constexpr (B::ColsAtCompileTime == 1)
      return solve_one(b);
    else
      return solve_all(b);
  }
  Eigen::MatrixXd pseudo_inverse() const;

 private:
  struct Factors;
  Eigen::MatrixXd solve_all(const Eigen::MatrixXd& b) const;
  Eigen::VectorXd solve_one(const Eigen::VectorXd& b) const;
  std::shared_ptr<const Factors> factors_;
};

}  // namespace gonio::linear
