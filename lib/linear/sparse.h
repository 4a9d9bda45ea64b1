// L L' of sparse symmetric positive definite matrices with a fill-reducing order (approximate minimum degree, Amestoy,
// Davis & Duff 1996): Eigen's SimplicialLLT, compiled once. For systems over a mesh, whose unknowns know few others.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>

namespace gonio::linear {

// One summand of an element; those of one place add up. Of the lower triangle: row >= column, others are not read.
struct Summand {
  std::uint32_t row = 0, column = 0;
  double value = 0;
};

class SparseLlt {
 public:
  explicit SparseLlt(std::uint32_t size);
  // False where the matrix is not positive definite. The order is found anew only where the pattern is another one.
  bool factor(std::span<const Summand> lower);
  Eigen::VectorXd solve(const Eigen::VectorXd& b) const;

 private:
  struct Factors;
  std::uint32_t size_;
  std::shared_ptr<Factors> factors_;
};

}  // namespace gonio::linear
