// Errors that a mask makes alike along much of a rim, or all of it: how large they are, from what is left after a fit.
// Private to alignment/.
//
// A threshold that is a little off moves all of a mask's rim outwards; shading, penumbrae and a rim correction that is
// wrong by a share of itself move long pieces of it. The autocorrelation over some tens of pixels (rim_covariance.h)
// does not hold them, since most of such an error is taken up by the fit: it moves the answer and leaves little. What
// is left follows: with u the errors of pieces of rim, in the mean of each,
//   m = K u,   K_pq = delta_pq - j_p' H^-1 s_q,
// m the pieces' mean offsets after the fit, j_p their mean slopes, s_q = sum of w j / sigma^2 over a piece, H the
// fit's own. The errors are u = b (of its mask) + c (of the piece) + e, e what the short autocorrelation makes of a
// mean, and b and c have a variance each, of objects' rims and of shadows'. Expected sums of squares of m over pieces
// and over masks are linear in these four; they are solved for, none negative (analysis of variance with unequal
// groups: Henderson 1953, method 1; Searle, Casella & McCulloch 1992). Where masks err by nothing in common they come
// out near nothing. b and c are then nuisances of the covariance: each adds its variance times s s' to the middle of
// the sandwich. One mask that serves under several lamps is one mask.
#pragma once
#include <Eigen/Core>
#include <vector>

#include "alignment/fit.h"

namespace gonio::alignment {

// A sighting's points that count, and slopes of their offsets by the numbers, times share / sigma: one row each.
struct RimSlopes {
  std::vector<std::size_t> used;
  Eigen::MatrixXd slopes;
};
RimSlopes rim_slopes(const Setting& setting, const Question& q, std::size_t sighting, const SightingFit& fit);

// Variances of errors that are common, px^2: of all of a mask's rim, and of pieces of it.
struct CommonErrors {
  double mask_px2[2] = {0, 0}, piece_px2[2] = {0, 0};  // of objects, of shadows
  Eigen::MatrixXd meat;                                // what they add to M of fit.h
};
// Of each sighting: over how many pixels errors are alike in any case, and what these make of the mean of n points,
// times n.
struct ShortErrors {
  double length_px = 1, variance_px2 = 0;
};
CommonErrors common_errors(const Question& q, const Fitted& f, const std::vector<RimSlopes>& slopes,
                           const std::vector<ShortErrors>& short_errors, const Eigen::MatrixXd& h_inverse);

}  // namespace gonio::alignment
