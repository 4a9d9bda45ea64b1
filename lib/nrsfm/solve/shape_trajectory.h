// Smooth trajectories in shape space, fitted with the shapes eliminated (variable projection).
//
//   W_p = M_p s_p + e,   M = [c_f1 D_f .. c_fK D_f],   C = C(x_1 .. x_F),   x_f = X' omega_f
//
// Omega F x d are the first cosines over time, X d x q the unknowns, D_f = s_f R_f 2 x 3 known, M_p the rows of M whose
// tracks are visible for point p, s_p its 3K coordinates in the basis shapes. For each X the s_p follow by least
// squares, so that f(X) = sum_p |r_p|^2 is minimized over X alone (Golub & Pereyra 1973). With Q_p an orthonormal basis
// of M_p's columns the Gauss-Newton matrix (Kaufman 1975) has the blocks
//   sum_f omega_f omega_f' (L_f' B_f L_f)_jl - sum_p T_pj' T_pl,
//   B_f = sum_p S_p' D_f' D_f S_p,  L_f = dC_f/dx_f (K x q),  T_p = sum_f (Q_pf' D_f S_p L_f) (x) omega_f'
// and is never formed from a Jacobian. (S_p: s_p as 3 x K.)
#pragma once
#include <Eigen/Core>
#include <functional>

#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

struct ShapeTrajectoryProblem {
  Eigen::MatrixXd tracks;  // 2F x P less the translation; 0 where missing
  Visible visible;         // F x P
  Eigen::MatrixXd rows;    // 2F x 3: D
  Eigen::MatrixXd omega;   // F x d
  // C_f (K) of x_f (q) and its slope (K x q).
  std::function<Eigen::VectorXd(const Eigen::VectorXd&)> coefficients;
  std::function<Eigen::MatrixXd(const Eigen::VectorXd&)> slope;
  Eigen::Index held = 0;  // the first columns of X stay as they start
  // Weights of |s_pk|^2, over the sum of c_fk^2 |D_f|^2 / 3 (of visible frames, times all over visible): of the basis
  // shapes after the first, and of the first, which is the mean.
  double ridge = 1e-14, mean_ridge = 1e-14;
  bool natural_size = false;  // of C: ridges count as if all c_fk were 1, so that C cannot shrink them
  // Basis shape k explains what the shapes before it leave, S_k = M_k^+ (W - sum_(j < k) M_j S_j), not all together.
  bool complementary = false;
  int most_iterations = 100;
  double tolerance = 1e-7;  // relative, of the cost
};
struct ShapeTrajectory {
  Eigen::MatrixXd x;             // d x q
  Eigen::MatrixXd coefficients;  // F x K
  Eigen::MatrixXd basis;         // 3K x P
  double cost = 0;
  int iterations = 0;
  bool converged = false;
};
ShapeTrajectory fit_shape_trajectory(const ShapeTrajectoryProblem& problem, const Eigen::MatrixXd& start);

// The same with what tracks leave open. Where frames miss points the translation follows the residuals in rounds; basis
// shapes have mean zero. `translation` and problem.tracks are updated. Few frames, or cameras that hardly turn, do not
// determine the 3K coordinates of a point: their prior is normal, of the size that the fit itself has,
//   ridge = sigma^2 / (F delta^2),   mean_ridge = sigma^2 / (F extent^2),
// delta^2 the mean square of what a rigid shape with the same cameras leaves, extent^2 of what it explains; sigma^2 the
// residuals' variance over what the fit leaves free, times (1 + rho) / (1 - rho) for their correlation rho over time.
// Exact tracks of shapes that the model contains come back exactly.
ShapeTrajectory fit_with_translation(ShapeTrajectoryProblem& problem, const Eigen::MatrixXd& start,
                                     Eigen::VectorXd& translation);

}  // namespace gonio::nrsfm
