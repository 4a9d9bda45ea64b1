// The cells of one class as a smooth function of their place on the sample, in one view.
//
// A polynomial in the place (order 2 where there are 24 cells or more, 1 from 9 on, else constant), fitted by
// iteratively reweighted least squares with Tukey's biweight (c = 4.685), started from Huber's: uneven light and the
// change of directions across the sample are in it, a few cells unlike the others are not. The scatter is 1.4826 times
// the median of the absolute residuals, times sqrt(n / (n - p)).
#pragma once
#include <Eigen/Core>
#include <vector>

#include "contrast/measure/pattern.h"

namespace gonio::contrast {

struct ClassFit {
  std::vector<double> expected;  // at every cell of the pattern
  double mean = 0, sigma = 0;    // of `expected` over the whole pattern
  double scatter = 0;            // of a cell about the polynomial
  double degrees = 0;            // n - p
  int order = 0, cells = 0;
};

int polynomial_order(std::size_t cells);
std::vector<double> polynomial_terms(Vec2 place, int order);

// `members`: the cells of the class; those whose value is NaN take no part. With fewer than 2 of them the scatter is
// that of `sigma`.
ClassFit fit_class(const CellPattern& pattern, const std::vector<std::size_t>& members,
                   const std::vector<double>& value, const std::vector<double>& sigma);

// The same fit for simulations: places of cells that always count.
class ClassShape {
 public:
  ClassShape(const CellPattern& pattern, const std::vector<std::size_t>& cells);
  Eigen::Index cells() const { return terms_.rows(); }
  // Of values of these cells from their polynomial, over their scatter.
  Eigen::VectorXd deviations(const Eigen::VectorXd& values) const;

 private:
  Eigen::MatrixXd terms_;
};

}  // namespace gonio::contrast
