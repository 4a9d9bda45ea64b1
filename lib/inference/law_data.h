// Residuals of a finished fit with its free parameters' columns at hand, so that laws are fitted, projected and judged
// on any part of the rows. Linear throughout: the free parameters move by Gauss-Newton steps. Private to the law.
//
// Columns are given raw, one number per row in the residual's unit, and are whitened here.
#pragma once
#include <vector>

#include "inference/explanation.h"
#include "inference/fit.h"
#include "inference/law_terms.h"
#include "inference/system.h"

namespace gonio::inference {

using RawColumns = std::vector<std::vector<double>>;

// Fall of chi-square that one further column would bring, the share of its length that survives the projection, and on
// how many blocks it lives: the square of its squared length over the sum of the blocks' squares.
struct Score {
  double fall = 0, survives = 0, blocks = 0;
};

class LawData {
 public:
  // The fit stands at `values`; `active` were free in it.
  LawData(const System& system, const std::vector<double>& values, const std::vector<std::size_t>& active);
  const System& system() const { return system_; }
  std::size_t blocks() const { return blocks_; }

  // Each of `candidates` beside the free parameters and the columns `chosen`, on the rows of `mask`.
  std::vector<Score> scores(const RawColumns& candidates, const RawColumns& chosen, const Mask& mask = {}) const;
  // Coefficients of `columns`, fitted with the free parameters on the rows of `mask`; `variance` is theirs for
  // independent rows.
  Eigen::VectorXd coefficients(const RawColumns& columns, const Mask& mask, Eigen::MatrixXd* variance = nullptr) const;
  // Whitened columns less what the free parameters imitate on all rows; the last one is the residual.
  Eigen::MatrixXd projected(const RawColumns& columns) const;
  // Covariance of the coefficients at `coefficients`: sandwich over blocks, as in fit.h.
  Eigen::MatrixXd covariance(const RawColumns& columns, const Eigen::VectorXd& coefficients) const;
  // Held-out groups with the free parameters and `columns` fitted on the others.
  HeldOut held_out(const RawColumns& columns) const;

 private:
  struct Group {
    std::size_t number = 0, first = 0;
    std::vector<std::size_t> places;  // of its columns, in the linearisation
    Eigen::MatrixXd whitened;         // [columns, residual]
    std::vector<std::size_t> block;   // of each row, from zero
    std::size_t blocks = 0;
  };
  // The linearisation with `columns` appended, on the rows of `mask`.
  Linearisation with(const RawColumns& columns, const Mask& mask) const;
  Eigen::MatrixXd whitened(const RawColumns& columns, const Group& group) const;
  static Eigen::VectorXd squares_of_blocks(const Eigen::MatrixXd& columns, const Group& group);
  std::vector<std::size_t> all_columns(const Linearisation& l) const;

  const System& system_;
  Linearisation own_;
  std::vector<Group> groups_;
  std::size_t blocks_ = 0, rows_ = 0;
};

}  // namespace gonio::inference
