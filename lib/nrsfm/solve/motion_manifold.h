// The motion manifold of low-rank shapes: 2 x 3K matrices [c_1 R .. c_K R], R (2 x 3) with orthonormal rows.
#pragma once
#include "nrsfm/solve/factorization.h"

namespace gonio::nrsfm {

// The nearest of them to M = [M_1 .. M_K] in the Frobenius norm (Paladini et al., CVPR 2009, section 4). Given R,
// c_k = <M_k, R> / 2, so that R maximizes  r' A r,  A = sum_k vec(M_k) vec(M_k)',  over orthonormal rows. A is positive
// semidefinite: R <- nearest rows to mat(A r) never falls, and several starts find the maximum. With the multiplier
// L = mat(A r) R' (2 x 2, symmetric at a stationary point), r' A r is the maximum where L (x) I_3 - A has no negative
// eigenvalue: the dual of the semidefinite relaxation, which the paper solves instead.
struct OnManifold {
  CameraRows rotation;
  Eigen::VectorXd weights;  // K
  bool certified = false;   // the nearest of all, not of its neighbourhood alone
};
OnManifold nearest_motion(const Eigen::MatrixXd& motion, const CameraRows& start);

}  // namespace gonio::nrsfm
