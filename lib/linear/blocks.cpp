// See blocks.h.
#include "linear/blocks.h"

#include "linear/qr.h"
#include "linear/symmetric_eigen.h"

namespace gonio::linear {

Eigen::MatrixXd gram_of(const Eigen::MatrixXd& a) {
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(a.cols(), a.cols());
  if (a.size() == 0) return gram;
  gram.selfadjointView<Eigen::Lower>().rankUpdate(a.transpose());
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  return gram;
}

EigenPairs eigen_of(const Eigen::MatrixXd& symmetric) {
  if (symmetric.size() == 0) return {Eigen::VectorXd(0), Eigen::MatrixXd(0, 0)};
  const SymmetricEigen<Eigen::MatrixXd> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Eigen::MatrixXd basis_of(const Eigen::MatrixXd& a) {
  if (a.size() == 0) return Eigen::MatrixXd(a.rows(), 0);
  const PivotedQr qr(a);
  return qr.orthonormal(qr.rank());
}

Eigen::VectorXd lengths_outside(const Eigen::MatrixXd& a, const Eigen::MatrixXd& v) {
  if (a.size() == 0 || v.size() == 0) return v.colwise().norm().transpose();
  const PivotedQr qr(a);
  Eigen::VectorXd lengths(v.cols());
  for (Eigen::Index k = 0; k < v.cols(); ++k) lengths[k] = qr.turned(v.col(k)).tail(v.rows() - qr.rank()).norm();
  return lengths;
}

}  // namespace gonio::linear
