#include "linear/qr.h"

#include <Eigen/QR>

namespace gonio::linear {

HouseholderQr::HouseholderQr(const Eigen::MatrixXd& a) {
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(a);
  q_ = qr.householderQ() * Eigen::MatrixXd::Identity(a.rows(), a.cols());
  upper_ = qr.matrixQR().topRows(a.cols()).triangularView<Eigen::Upper>();
}

struct PivotedQr::Factors {
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr;
};
PivotedQr::PivotedQr(const Eigen::MatrixXd& a)
    : factors_(std::make_shared<const Factors>(Factors{Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(a)})) {}
PivotedQr::PivotedQr(const Eigen::MatrixXd& a, double threshold) {
  Factors factors{Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(a)};
  factors.qr.setThreshold(threshold);
  factors_ = std::make_shared<const Factors>(std::move(factors));
}
Eigen::Index PivotedQr::rank() const {
  return factors_->qr.rank();
}
Eigen::MatrixXd PivotedQr::solve_all(const Eigen::MatrixXd& b) const {
  return factors_->qr.solve(b);
}
Eigen::VectorXd PivotedQr::solve_one(const Eigen::VectorXd& b) const {
  return factors_->qr.solve(b);
}
Eigen::MatrixXd PivotedQr::orthonormal(Eigen::Index columns) const {
  return factors_->qr.householderQ() * Eigen::MatrixXd::Identity(factors_->qr.rows(), columns);
}
Eigen::MatrixXd PivotedQr::all_turned(const Eigen::MatrixXd& v) const {
  return factors_->qr.householderQ().adjoint() * v;
}

struct LeastNorm::Factors {
  Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> cod;
};
LeastNorm::LeastNorm(const Eigen::MatrixXd& a)
    : factors_(std::make_shared<const Factors>(Factors{Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(a)})) {}
Eigen::Index LeastNorm::rank() const {
  return factors_->cod.rank();
}
Eigen::MatrixXd LeastNorm::solve_all(const Eigen::MatrixXd& b) const {
  return factors_->cod.solve(b);
}
Eigen::VectorXd LeastNorm::solve_one(const Eigen::VectorXd& b) const {
  return factors_->cod.solve(b);
}
Eigen::MatrixXd LeastNorm::pseudo_inverse() const {
  return factors_->cod.pseudoInverse();
}

}  // namespace gonio::linear
