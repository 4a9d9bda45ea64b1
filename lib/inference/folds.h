// Leave one group out for thousands of hypotheses at the price of one. The model's own parameters are eliminated once
// for every fold; what is left of each foreign column (a mechanism's, a curve's, a negative control's) is a small
// matrix per fold, and any set of them, singles, pairs, triples, is scored by solving in that matrix.
//
// With x the own and t the foreign steps, fold g (all groups but g) has x = u - U t, so that
//   S t = b,  S = F - C'U, b = c - U'a  (Schur complement of the fold's normal equations), and the held-out residual is
//   R = (r - A u) - (A_f - A U) t: squared, a quadratic form in (t, 1).
// Numbers of the held-out group alone are fitted on one half of its blocks and judged on the other, as in held_out.cpp:
// the own ones are eliminated beforehand, the foreign ones for each hypothesis.
//
// Scores are linear: bounds that lie at the neutral value are kept (a lamp has no negative radius), others are not.
#pragma once
#include <vector>

#include "inference/fit.h"

namespace gonio::inference {

class Folds {
 public:
  // The first `l.own` columns are the model's; the others are foreign.
  Folds(const System& system, const Linearisation& l);

  // Foreign columns, numbered from zero. `whitened` and `rows` only.
  HeldOut held_out(const std::vector<Eigen::Index>& foreign) const;
  // Mean fall of the held-out square per row against the model alone.
  double gain(const std::vector<Eigen::Index>& foreign) const;
  const HeldOut& own() const { return own_; }
  // The step that all groups together want, and the share of each column's squared length that survives in it.
  Eigen::VectorXd step(const std::vector<Eigen::Index>& foreign) const;
  // Mean fall of the square per row that this step promises, of the very groups that it was fitted to.
  double promise(const std::vector<Eigen::Index>& foreign) const;

 private:
  struct Fold {
    std::size_t group = 0;
    double rows = 0;
    Eigen::MatrixXd normal;     // S and, in the last column, b
    Eigen::MatrixXd judged[2];  // quadratic form in (t, 1) on the other half than the one fitted
    Eigen::MatrixXd fitted[2];  // the same on the half that own numbers of the group are fitted on; where there are any
    bool halved = false;        // the model itself has numbers of this group
  };
  Fold everything(const Linearisation& l, const Eigen::MatrixXd& joint);
  Fold without(const System& system, const Linearisation& l, const GroupGram& left_out, const Eigen::MatrixXd& normal,
               const Eigen::MatrixXd& moved) const;
  void add_priors(const Linearisation& l, const Eigen::VectorXd& length, Fold& fold) const;
  double squares(const Fold& fold, const std::vector<Eigen::Index>& foreign) const;
  Eigen::VectorXd solved(const Fold& fold, const std::vector<Eigen::Index>& shared) const;

  std::vector<Fold> folds_;
  Fold all_;
  std::vector<std::size_t> local_;  // of every foreign column
  std::vector<int> side_;           // sign that a column's step must have; 0: any
  Eigen::VectorXd full_;            // squared lengths before projection
  HeldOut own_;
  double rows_ = 0;
};

}  // namespace gonio::inference
