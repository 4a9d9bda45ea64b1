// Products and decompositions of blocks that may be empty: a group without rows, a half without blocks, a mechanism
// without numbers, a model in which nothing is free. Eigen divides by zero in a symmetric product without rows, and has
// no decomposition of a matrix without columns; here such blocks give what sums and spans over nothing are. Whatever in
// inference multiplies a block with itself or decomposes one does it here.
#pragma once
#include <Eigen/Core>

namespace gonio::linear {

Eigen::MatrixXd gram_of(const Eigen::MatrixXd& a);  // A'A; zero where A has no rows

struct EigenPairs {
  Eigen::VectorXd values;   // ascending
  Eigen::MatrixXd vectors;  // one a column
  double largest() const { return values.size() > 0 ? values[values.size() - 1] : 0; }
};
EigenPairs eigen_of(const Eigen::MatrixXd& symmetric);

// Orthonormal columns that span those of `a`: as many as its rank.
Eigen::MatrixXd basis_of(const Eigen::MatrixXd& a);
// Of each column of `v`: the length of what the columns of `a` do not span.
Eigen::VectorXd lengths_outside(const Eigen::MatrixXd& a, const Eigen::MatrixXd& v);

}  // namespace gonio::linear
