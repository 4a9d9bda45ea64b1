// What estimates of a fitted linear model rest on: its QR decomposition. Kept from anova.h, so that no matrix library
// enters the headers of other rooms.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "stats/anova.h"

namespace gonio::stats {

// The fit in coordinates where the columns are a triangle: y = Q (R beta) + error, Q'Q = 1. R has a column for every
// column of the model matrix, aliased ones included; rows for the r that are independent.
struct Projections {
  std::vector<Term> terms;
  Eigen::MatrixXd r;           // r x p
  std::vector<int> kept;       // the independent columns, in order
  Eigen::VectorXd z;           // Q'y
  Eigen::MatrixXd covariance;  // of z, as chosen
  Eigen::MatrixXd q;           // n x r
};

}  // namespace gonio::stats
