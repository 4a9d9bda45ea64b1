// Shapes as sums of few others: which frames share a subspace, without saying how many subspaces there are.
#pragma once
#include <Eigen/Core>

namespace gonio::nrsfm {

// C (F x F, zero diagonal) with X' ~ X' C for the rows of X (F x n), less their mean: the support by the lasso
//   min 1/2 |X' - X' C|_F^2 + alpha |C|_1   (Elhamifar & Vidal, PAMI 35 (2013), equation 13),
// alpha `sparsity` (> 1) times less than the largest at which no column of C is zero (their proposition 1); the weights
// of that support by least squares with a small ridge, so that what lies in the subspaces is not shrunk.
Eigen::MatrixXd self_expression(const Eigen::MatrixXd& rows, double sparsity);

}  // namespace gonio::nrsfm
