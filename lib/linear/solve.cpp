#include "linear/solve.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>

namespace gonio::linear {

namespace compiled {

template <int N, int C>
Eigen::Matrix<double, N, C> ldlt_solution(const Eigen::Matrix<double, N, N>& a, const Eigen::Matrix<double, N, C>& b) {
  constexpr int n = N <= 6 ? N : Eigen::Dynamic;  // larger ones gain nothing from a size of their own
  return Eigen::LDLT<Eigen::Matrix<double, n, n>>(a).solve(b);
}
template <int N>
Eigen::Matrix<double, N, N> inverse(const Eigen::Matrix<double, N, N>& a) {
  return Eigen::MatrixXd(a).inverse();
}

constexpr int any = Eigen::Dynamic;
#define GONIO_LDLT(N, C)                                                                 \
  template Eigen::Matrix<double, N, C> ldlt_solution(const Eigen::Matrix<double, N, N>&, \
                                                     const Eigen::Matrix<double, N, C>&)
GONIO_LDLT(any, 1);
GONIO_LDLT(any, any);
GONIO_LDLT(any, 2);
GONIO_LDLT(2, 1);
GONIO_LDLT(3, 1);
GONIO_LDLT(3, 2);
GONIO_LDLT(3, any);
GONIO_LDLT(4, 1);
GONIO_LDLT(5, 1);
GONIO_LDLT(6, 1);
GONIO_LDLT(6, 6);
GONIO_LDLT(6, 12);
GONIO_LDLT(6, 21);
GONIO_LDLT(6, any);
GONIO_LDLT(7, 1);
GONIO_LDLT(8, 1);
GONIO_LDLT(10, 1);
GONIO_LDLT(12, 1);
GONIO_LDLT(12, 12);
#undef GONIO_LDLT
template Eigen::MatrixXd inverse(const Eigen::MatrixXd&);
template Eigen::Matrix2d inverse(const Eigen::Matrix2d&);
template Eigen::Matrix3d inverse(const Eigen::Matrix3d&);
template Eigen::Matrix<double, 6, 6> inverse(const Eigen::Matrix<double, 6, 6>&);
template Eigen::Matrix<double, 8, 8> inverse(const Eigen::Matrix<double, 8, 8>&);

}  // namespace compiled

struct Ldlt::Factors {
  Eigen::LDLT<Eigen::MatrixXd> ldlt;
};
Ldlt::Ldlt(const Eigen::MatrixXd& a)
    : factors_(std::make_shared<const Factors>(Factors{Eigen::LDLT<Eigen::MatrixXd>(a)})) {}
Eigen::MatrixXd Ldlt::solve_all(const Eigen::MatrixXd& b) const {
  return factors_->ldlt.solve(b);
}
Eigen::VectorXd Ldlt::solve_one(const Eigen::VectorXd& b) const {
  return factors_->ldlt.solve(b);
}
Eigen::ComputationInfo Ldlt::info() const {
  return factors_->ldlt.info();
}
Eigen::MatrixXd Ldlt::root() const {
  const auto& f = factors_->ldlt;
  Eigen::MatrixXd root = f.matrixL();
  root = (root * f.vectorD().cwiseMax(0.0).cwiseSqrt().asDiagonal()).eval();
  return f.transpositionsP().transpose() * root;
}

struct Llt::Factors {
  Eigen::LLT<Eigen::MatrixXd> llt;
};
Llt::Llt(const Eigen::MatrixXd& a)
    : factors_(std::make_shared<const Factors>(Factors{Eigen::LLT<Eigen::MatrixXd>(a)})) {}
Eigen::MatrixXd Llt::solve_all(const Eigen::MatrixXd& b) const {
  return factors_->llt.solve(b);
}
Eigen::VectorXd Llt::solve_one(const Eigen::VectorXd& b) const {
  return factors_->llt.solve(b);
}
Eigen::MatrixXd Llt::lower_all(const Eigen::MatrixXd& b) const {
  return factors_->llt.matrixL().solve(b);
}
Eigen::VectorXd Llt::lower_one(const Eigen::VectorXd& b) const {
  return factors_->llt.matrixL().solve(b);
}
Eigen::MatrixXd Llt::lower() const {
  return factors_->llt.matrixL();
}
Eigen::VectorXd Llt::diagonal() const {
  return factors_->llt.matrixLLT().diagonal();
}
Eigen::ComputationInfo Llt::info() const {
  return factors_->llt.info();
}

}  // namespace gonio::linear
