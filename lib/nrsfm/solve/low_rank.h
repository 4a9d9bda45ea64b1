// Shapes of least nuclear norm that reproject as their tracks, whatever the number of basis shapes.
//   min |S#|_* + (coupling / 2) |D S#|_F^2   subject to   M_f S_f = W_f
// S# (F x 3P) has one row per frame: its x, then y, then z. With M_f = s_f R_f (2 x 3) given, each frame is free in one
// number per point alone, its depth: S_f = M_f^+ W_f + n_f y_f', n_f the unit vector that M_f does not see. The problem
// is convex; alternating directions (Boyd et al. 2011, section 3) between the norm, by thresholds of singular values
// (Cai, Candes & Shen 2010), and the depths, by least squares, find its minimum. |Q|_2 <= 1 with sum_a n_fa Q_a = 0
// bounds it from below:  |S#|_* >= <Q, (M^+ W)#>, so that the answer states how far from the minimum it can be.
#pragma once
#include <Eigen/Core>

#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

Eigen::MatrixXd rearranged(const Shapes& shapes);  // 3F x P -> F x 3P
Shapes arranged(const Eigen::MatrixXd& rows);      // back

struct LowRankProblem {
  const Eigen::MatrixXd& w;     // 2F x P, centred
  const Eigen::MatrixXd& rows;  // 2F x 3: M_f
  Eigen::MatrixXd laplacian;    // F x F: D'D; empty: no coupling
  double coupling = 0;
};
struct LowRankOptions {
  double tolerance = 1e-4;  // of both residuals, relative
  int most_iterations = 500;
};
struct LowRankShapes {
  Shapes shapes;            // M_f S_f = W_f to rounding
  double nuclear_norm = 0;  // of its S#
  double bound = 0;         // no solution has less; only without coupling
  Eigen::Index rank = 0;    // of the thresholded S#
  int iterations = 0;
  bool converged = false;
};
// From `start` (3F x P), or from the shapes of least Frobenius norm where that is empty.
LowRankShapes low_rank_shapes(const LowRankProblem& problem, const LowRankOptions& options, const Shapes& start = {});

}  // namespace gonio::nrsfm
