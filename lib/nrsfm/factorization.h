// What factorization methods have in common. W is 2F x P, its translation removed; W = M B with M 2F x 3K.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

// Tracks less each frame's mean over its visible points; missing entries become 0.
struct Centred {
  Eigen::MatrixXd w;            // 2F x P
  Eigen::VectorXd translation;  // 2F
};
Centred centred(const Sequence& sequence);

// The 2F x 3 rows of rotations (each pair orthonormal, after scale) and scales of a motion matrix of rank 3K:
// finds the 3K x 3 corrective transform G with M_2f G G' M_2f' = s_f^2 I by least squares on Q = G G' and refinement of
// G by Levenberg-Marquardt (Akhter et al. 2008, section 4; Xiao et al. 2004). `rows` are the 2F x 3K motion.
struct Upgrade {
  Eigen::MatrixXd transform;                           // 3K x 3
  std::vector<Eigen::Matrix<double, 2, 3>> rotations;  // orthonormal rows
  Eigen::VectorXd scales;                              // F, > 0
  double residual = 0;  // rms of the orthonormality constraints over the mean square of the scales
};
Upgrade metric_upgrade(const Eigen::MatrixXd& rows);

// F x K orthonormal DCT-II basis of trajectories; column 0 is constant.
Eigen::MatrixXd dct_basis(Eigen::Index frames, Eigen::Index terms);

// Nearest 2 x 3 (3 x 3) matrix with orthonormal rows (a proper rotation).
Eigen::Matrix<double, 2, 3> nearest_rows(const Eigen::Matrix<double, 2, 3>& a);
Eigen::Matrix3d completed(const Eigen::Matrix<double, 2, 3>& rows);

// Low-rank completion of missing entries, W ~ A B, rank r, by alternating least squares with a small ridge (Hartley &
// Schaffalitzky 2003; Buchanan & Fitzgibbon 2005 say where it fails), for solvers that need a start.
struct Completion {
  Eigen::MatrixXd w;
  Eigen::VectorXd translation;
  int iterations = 0;
  bool converged = false;
};
Completion complete(const Sequence& sequence, int rank, int most_iterations = 300);

// Shapes of a rank-3K model: S_f = sum_k c_fk B_k.
Shapes shapes_of(const Eigen::MatrixXd& coefficients, const Eigen::MatrixXd& basis);  // F x K, 3K x P

}  // namespace gonio::nrsfm
