// Solutions of symmetric systems, and inverses: Eigen's LDLT, LLT and LU, compiled once for the sizes that solve.cpp
// lists (another one is one line there, until then the linker misses it).
#pragma once
#include <Eigen/Core>
#include <memory>

namespace gonio::linear {

namespace compiled {
template <int N, int C>
Eigen::Matrix<double, N, C> ldlt_solution(const Eigen::Matrix<double, N, N>& a, const Eigen::Matrix<double, N, C>& b);
template <int N>
Eigen::Matrix<double, N, N> inverse(const Eigen::Matrix<double, N, N>& a);
// The size of a square expression: fixed where one of its sides is.
template <class A>
constexpr int size_of() {
  return A::RowsAtCompileTime == Eigen::Dynamic ? A::ColsAtCompileTime : A::RowsAtCompileTime;
}
}  // namespace compiled

// x with A x = b for symmetric A, positive or negative semidefinite, by robust Cholesky (L D L' with pivoting):
// directions whose pivot is zero get no step. Only the lower triangle of A is read.
template <class A, class B>
Eigen::Matrix<double, compiled::size_of<A>(), B::ColsAtCompileTime> solve_ldlt(const Eigen::MatrixBase<A>& a,
                                                                               const Eigen::MatrixBase<B>& b) {
  return compiled::ldlt_solution<compiled::size_of<A>(), B::ColsAtCompileTime>(a, b);
}

// By partial pivoting; of a singular matrix it is not finite.
template <class A>
Eigen::Matrix<double, compiled::size_of<A>(), compiled::size_of<A>()> inverse(const Eigen::MatrixBase<A>& a) {
  return compiled::inverse<compiled::size_of<A>()>(a);
}

// L D L' that is kept, to solve with it more than once. Copies share it.
class Ldlt {
 public:
  Ldlt() = default;  // solves nothing
  explicit Ldlt(const Eigen::MatrixXd& a);
  template <class B>
  auto solve(const Eigen::MatrixBase<B>& b) const {
    if constexpr (B::ColsAtCompileTime == 1)
      return solve_one(b);
    else
      return solve_all(b);
  }
  Eigen::ComputationInfo info() const;
  Eigen::MatrixXd root() const;  // R with R R' = A, where negative pivots count as zero

 private:
  struct Factors;
  Eigen::MatrixXd solve_all(const Eigen::MatrixXd& b) const;
  Eigen::VectorXd solve_one(const Eigen::VectorXd& b) const;
  std::shared_ptr<const Factors> factors_;
};

// L L' of a positive definite matrix, kept. Copies share it.
class Llt {
 public:
  Llt() = default;
  explicit Llt(const Eigen::MatrixXd& a);
  template <class B>
  auto solve(const Eigen::MatrixBase<B>& b) const {
    if constexpr (B::ColsAtCompileTime == 1)
      return solve_one(b);
    else
      return solve_all(b);
  }
  template <class B>
  auto solve_lower(const Eigen::MatrixBase<B>& b) const {  // L^-1 b
    if constexpr (B::ColsAtCompileTime == 1)
      return lower_one(b);
    else
      return lower_all(b);
  }
  Eigen::MatrixXd lower() const;        // L
  Eigen::VectorXd diagonal() const;     // of L: the root of the determinant is its product
  Eigen::ComputationInfo info() const;  // Success: A is positive definite

 private:
  struct Factors;
  Eigen::MatrixXd solve_all(const Eigen::MatrixXd& b) const;
  Eigen::VectorXd solve_one(const Eigen::VectorXd& b) const;
  Eigen::MatrixXd lower_all(const Eigen::MatrixXd& b) const;
  Eigen::VectorXd lower_one(const Eigen::VectorXd& b) const;
  std::shared_ptr<const Factors> factors_;
};

}  // namespace gonio::linear
