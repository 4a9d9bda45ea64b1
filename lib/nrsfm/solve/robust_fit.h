// The truncated error of Jensen et al. 2018 as a function of one similarity, and its minimization.
//
//   y_i = s R x_i + t,   e_i = y_i - q_i,   d_i = |e_i|,   W = E3 + 1.5 (E3 - E1) = 2.5 E3 - 1.5 E1
//   F = 1/N sum rho(min(d_i, W)),   rho(d) = d^2 (root mean square) or d (as printed);   the measure is sqrt(F)
//
// A step p = (log-scale, rotation vector, translation) takes y to exp(p_0) exp[p_123] y + p_456: about y the Jacobian
// is J_i = [y_i, -[y_i]x, I]. With v_i = J_i' e_i the sum over i with d_i < W has
//   gradient  sum w1 v_i,   generalized Gauss-Newton matrix  sum w1 J_i' J_i + w2 v_i v_i',
//   w1 = rho'(d)/d,   w2 = (rho'' - rho'/d)/d^2
// and the n points beyond add n rho(W): gradient n rho'(W) W', matrix n rho''(W) W' W'^T. W' comes from the derivatives
// of the two quartiles, d_k' = v_k/d_k; of a single point that is as rough as the sample, so that it is averaged over
// the points whose ranks lie next to the quartile's (the derivative of the quantile of a smooth distribution).
#pragma once
#include <Eigen/Core>
#include <vector>

#include "nrsfm/evaluate/alignment.h"
#include "nrsfm/evaluate/errors.h"

namespace gonio::nrsfm {

using Step = Eigen::Matrix<double, 7, 1>;
using StepMatrix = Eigen::Matrix<double, 7, 7>;

// The similarity that takes x to exp(p_0) exp[p_123] y + p_456, y = `at` of x.
Similarity stepped(const Similarity& at, const Step& p);

class RobustFit {
 public:
  RobustFit(const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xd& q, RobustMean mean);

  struct State {
    Similarity at;
    double cost = 0;              // F
    double whisker = 0;           // W
    double lower = 0, upper = 0;  // E1, E3
    Eigen::Index beyond = 0;      // points truncated
  };
  State evaluate(const Similarity& at);
  struct Derivatives {
    Step gradient;
    StepMatrix matrix;
  };
  Derivatives derivatives(const State& state);  // of the state that was evaluated last

  struct Outcome {
    State state;
    int iterations = 0;
    bool converged = false;
  };
  // Levenberg-Marquardt from `start`.
  Outcome minimize(const Similarity& start, int most_iterations);
  // Simplexes (Nelder & Mead 1965) about `state`, smaller and smaller, for the corners that derivatives do not see: of
  // few points the measure has many, where one distance crosses the whisker or becomes a quartile.
  State polished(const State& state, int most_evaluations);

 private:
  void quartiles(State& state);
  struct Guess {
    double value = 0, width = 0.4;  // a squared quartile; how far it may move, relative
  };
  void ordered(Eigen::Index k, const Guess& guess, std::vector<double>& two);
  Step mean_gradient(double centre) const;
  int simplex(State& best, double size, int most_evaluations);
  void subtract_along(const Eigen::ArrayXd& w2, StepMatrix& matrix) const;

  Eigen::Index n_;
  RobustMean mean_;
  Eigen::ArrayX3d x_, q_, y_, e_;  // a point a row: sums run down the columns
  Eigen::ArrayXd d2_;
  std::vector<double> gathered_;
  Guess guess_[2];  // from the evaluation before
};

}  // namespace gonio::nrsfm
