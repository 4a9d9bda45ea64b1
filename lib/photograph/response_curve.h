// Log exposure over code, 0 to 255, rising by construction: the integral of exp(q), q a uniform cubic B-spline over
// log((code + 4) / (275 - code)), 0 at code 127.5. Tabulated at quarters of a code. Eigen in this header: for
// response_fit.cpp alone.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "photograph/response_fit.h"

namespace gonio::photograph {

class ResponseCurveShape {
 public:
  static constexpr Eigen::Index terms = 16;
  ResponseCurveShape();  // that of code ~ light^(1 / 2.2)
  void set(const Eigen::VectorXd& coefficients);
  const Eigen::VectorXd& coefficients() const { return q_; }

  double value(double code) const;
  double slope(double code) const;
  double code(double value) const;              // the inverse, 0 to 255
  Eigen::VectorXd gradient(double code) const;  // of value(), by the coefficients

 private:
  Eigen::VectorXd q_;
  std::vector<double> value_, slope_;
  Eigen::MatrixXd gradient_;  // a column for each place of the table
};

// Linear values, 0.2140 at code 127.5, and their uncertainty, at codes so near to each other that lines between them
// are off by less than 0.1 % of a power law. `covariance`: of the coefficients. Below the code `lowest` (0 to 255) a
// line to no light at code 0, above `highest` the last slope; both are guesses, as uncertain as they are far from the
// curve.
std::vector<ResponseRow> rows_of(const ResponseCurveShape& shape, const Eigen::MatrixXd& covariance, double lowest,
                                 double highest);

}  // namespace gonio::photograph
