// The lasso by alternating directions, and least squares on its support.
#include "nrsfm/solve/self_expression.h"

#include <Eigen/Core>
#include <algorithm>
#include <vector>

#include "base/atomic_file.h"
#include "linear/solve.h"
#include "linear/symmetric_eigen.h"

namespace gonio::nrsfm {
namespace {

// The lasso of every column at once by alternating directions; (G + rho I)^-1 from the eigenvectors of G = X'X, which
// has at most 3P eigenvalues that are not zero.
Eigen::MatrixXd lasso(const Eigen::MatrixXd& shapes, double sparsity) {
  const Eigen::Index frames = shapes.rows();
  const Eigen::MatrixXd gram = shapes * shapes.transpose();
  Eigen::MatrixXd apart = gram.cwiseAbs();
  apart.diagonal().setZero();
  const double alpha = apart.colwise().maxCoeff().minCoeff() / sparsity;  // above it a column of C would be zero
  const linear::SymmetricEigen<Eigen::MatrixXd> eigen(gram);
  const Eigen::Index rank = std::min(frames, shapes.cols());
  const Eigen::MatrixXd v = eigen.eigenvectors().rightCols(rank);
  const Eigen::VectorXd lambda = eigen.eigenvalues().tail(rank).cwiseMax(0);
  const double rho = sparsity * alpha / 10;
  const Eigen::VectorXd shrink = lambda.array() / (lambda.array() + rho);
  Eigen::MatrixXd c = Eigen::MatrixXd::Zero(frames, frames), u = c, b, j;
  for (int iteration = 0; iteration < 120; ++iteration) {
    throw_if_interrupted();
    b = gram / rho + c - u;
    j = b;
    j.noalias() -= v * (shrink.asDiagonal() * (v.transpose() * b));
    const Eigen::ArrayXXd t = (j + u).array();
    Eigen::MatrixXd next = (t.sign() * (t.abs() - alpha / rho).max(0)).matrix();
    next.diagonal().setZero();
    u += j - next;
    const double change = (next - c).norm(), apart_from = (j - next).norm(), size = next.norm();
    c = std::move(next);
    if (change < 1e-3 * size && apart_from < 1e-3 * size) break;
  }
  return c;
}

// The weights that the lasso chooses, by least squares: what lies in the subspaces is not shrunk. A small ridge.
Eigen::MatrixXd refitted(const Eigen::MatrixXd& shapes, const Eigen::MatrixXd& chosen) {
  const Eigen::MatrixXd gram = shapes * shapes.transpose();
  const double ridge = 1e-3 * gram.diagonal().mean();
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(chosen.rows(), chosen.cols());
  for (Eigen::Index f = 0; f < chosen.cols(); ++f) {
    std::vector<Eigen::Index> support;
    for (Eigen::Index g = 0; g < chosen.rows(); ++g) {
      if (chosen(g, f) != 0) support.push_back(g);
    }
    Eigen::MatrixXd normal = gram(support, support);
    normal.diagonal().array() += ridge;
    const Eigen::VectorXd right = gram(support, f);
    const Eigen::VectorXd c = linear::solve_ldlt(normal, right);
    for (std::size_t i = 0; i < support.size(); ++i) weights(support[i], f) = c(static_cast<Eigen::Index>(i));
  }
  return weights;
}

}  // namespace

Eigen::MatrixXd self_expression(const Eigen::MatrixXd& rows, double sparsity) {
  const Eigen::MatrixXd less = rows.rowwise() - rows.colwise().mean();
  if (less.squaredNorm() <= 1e-24 * rows.squaredNorm()) return Eigen::MatrixXd::Zero(rows.rows(), rows.rows());
  return refitted(less, lasso(less, sparsity));
}

}  // namespace gonio::nrsfm
