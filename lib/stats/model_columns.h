// Columns of a linear model of categorical factors, and sequential least squares on them. Private to lib/stats.
//
// A factor of L levels has L - 1 columns: 1 at its level, -1 at the last one, else 0. An interaction has the products
// of its factors' columns, the last factor fastest. Column 0 is the mean.
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>

#include "stats/anova.h"

namespace gonio::stats {

struct Block {
  int first = 0, count = 0;
};
class ModelColumns {
 public:
  ModelColumns(const Design& design, const std::vector<Term>& terms);
  int columns() const { return columns_; }
  Block block(std::size_t term) const { return blocks_[term]; }
  Eigen::MatrixXd matrix(const Design& design) const;  // n x p
  // The term's part of a row at these levels (of its factors, in their order).
  Eigen::VectorXd part(std::size_t term, std::span<const int> levels) const;

 private:
  std::vector<Term> terms_;
  std::vector<int> levels_;  // of each factor
  std::vector<Block> blocks_;
  int columns_ = 1;
};

// Householder's triangle column by column in the order given; a column of which less than 1e-7 is left behind the
// earlier ones is passed over, as in R's lm (LINPACK's dqrdc2).
struct Triangle {
  Eigen::MatrixXd r;      // rank x p
  std::vector<int> kept;  // columns that were not passed over
  Eigen::MatrixXd q;      // n x rank
};
Triangle triangle(Eigen::MatrixXd columns);

// Fills in mean and coefficients of a fit.
void add_coefficients(const Design& design, Anova& fit);

// lambda with contrast = R' lambda, so that the contrast's estimate is lambda'Q'y; empty where there is none.
Eigen::VectorXd estimable(const Projections& fit, const Eigen::VectorXd& contrast);
// The contrast "mu + all coefficients of terms of these factors" at these levels; `only`: that term's alone.
Eigen::VectorXd contrast_at(const Design& design, const Projections& fit, const Term& factors,
                            std::span<const int> levels, bool only);
// All combinations of the factors' levels, the last factor fastest.
std::vector<std::vector<int>> all_levels(const Design& design, const Term& factors);

}  // namespace gonio::stats
