// Sparse Cholesky factors: see sparse.h.
#include "linear/sparse.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <vector>

namespace gonio::linear {
namespace {

using SparseColumns = Eigen::SparseMatrix<double>;

bool same_pattern(const SparseColumns& a, const SparseColumns& b) {
  return a.cols() == b.cols() && a.nonZeros() == b.nonZeros() &&
         std::equal(a.outerIndexPtr(), a.outerIndexPtr() + a.cols() + 1, b.outerIndexPtr()) &&
         std::equal(a.innerIndexPtr(), a.innerIndexPtr() + a.nonZeros(), b.innerIndexPtr());
}

}  // namespace

struct SparseLlt::Factors {
  SparseColumns matrix;
  Eigen::SimplicialLLT<SparseColumns> llt;
};

SparseLlt::SparseLlt(std::uint32_t size) : size_(size), factors_(std::make_shared<Factors>()) {}

bool SparseLlt::factor(std::span<const Summand> lower) {
  std::vector<Eigen::Triplet<double>> triplets;
  triplets.reserve(lower.size());
  for (const Summand& s : lower)
    if (s.row >= s.column) triplets.emplace_back(static_cast<int>(s.row), static_cast<int>(s.column), s.value);
  SparseColumns matrix(size_, size_);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  const bool known = same_pattern(matrix, factors_->matrix);
  factors_->matrix = std::move(matrix);
  if (!known) factors_->llt.analyzePattern(factors_->matrix);
  factors_->llt.factorize(factors_->matrix);
  return factors_->llt.info() == Eigen::Success;
}

Eigen::VectorXd SparseLlt::solve(const Eigen::VectorXd& b) const {
  return factors_->llt.solve(b);
}

}  // namespace gonio::linear
