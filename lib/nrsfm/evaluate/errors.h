// How far a reconstruction lies from the truth: the measures of the literature, each named together with its alignment.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "nrsfm/evaluate/alignment.h"
#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

// Akhter et al. 2008: mean over frames and points of |x - q|, over sigma: the mean over frames and axes of the
// population standard deviation of the truth, both centred per frame.
double e3d(const Shapes& x, const Shapes& truth, Alignment alignment);
// Mean over frames of |X_f - Q_f|_F / |Q_f|_F (Dai et al. 2012).
double nrmse(const Shapes& x, const Shapes& truth, Alignment alignment);
// Root of the mean squared distance, and the mean distance, in the truth's unit.
double rmse(const Shapes& x, const Shapes& truth, Alignment alignment);
double mean_distance(const Shapes& x, const Shapes& truth, Alignment alignment);

// The same measures of shapes that are aligned already.
double e3d(const Aligned& aligned);
double nrmse(const Aligned& aligned);
double rmse(const Aligned& aligned);
double mean_distance(const Aligned& aligned);

// Jensen et al. 2018, section 4: distances above E3 + 1.5 (E3 - E1) (Tukey's whisker; E1, E3 the quartiles, linear
// between order statistics) count as that much. Their equation 3 has the root of the mean of t; a root mean SQUARE, as
// its name and unit say, has t^2.
enum class RobustMean { root_mean_square, printed };
struct RobustOptions {
  RobustMean mean = RobustMean::root_mean_square;
  bool reflection = true;
  int most_iterations = 200;  // of each start
};
struct RobustError {
  double value = 0;       // the truth's unit (its root where `printed`)
  double whisker = 0;     // E3 + w at the minimum
  double truncated = 0;   // share of the points
  double estimated = 1;   // share of frames x points that the reconstruction estimates
  Similarity alignment;   // the one similarity for the whole sequence
  double other_hand = 0;  // the least found with the other handedness; NaN where that was not tried
  Similarity other;       // ... and its similarity
  int iterations = 0;     // of all starts
  int starts = 0;
  bool converged = false;
};
// The least over scale, rotation (with reflection) and translation of the whole sequence, by Levenberg-Marquardt from
// Procrustes starts: of all points with either handedness, and where the error is not small against the truth's extent
// also of parts of the sequence. The whisker moves with the distances, and so does its derivative; a step is accepted
// only where the measure itself falls.
RobustError robust_error(const Shapes& x, const Shapes& truth, const RobustOptions& options = {});
// The measure where x lies, nothing aligned.
double robust_measure(const Shapes& x, const Shapes& truth, RobustMean mean = RobustMean::root_mean_square);

// Frames that are upside down although the rest is not: the depth of a frame, or the whole frame, mirrored.
//   depth reversal: x - 2 n (n . x) about the frame's centre, n the direction of depth
//   mirror:         -x about the frame's centre (the sign of a factorization's row)
// Statistic of a frame: z = atanh(r), r the correlation with the truth of what the flip would turn (its depths, or all
// of it). Flips make it negative. What frames that are not flipped have is estimated from the sequence itself: median
// and the spread above it, which flips of a minority can only lower and widen. A frame flips where z < 0 and the normal
// probability of so low a z is below false_alarm over the number of frames and kinds.
enum class FlipKind { none, depth_reversal, mirror };
struct Flip {
  Eigen::Index frame = 0;
  FlipKind kind = FlipKind::none;
  double error_before = 0, error_after = 0;  // rms distance after the sequence's similarity; and with the flip undone
  Eigen::Vector3d depth = Eigen::Vector3d::Zero();  // of a depth reversal: the direction, in the frame of x
};
struct FlipOptions {
  std::vector<Eigen::Vector3d> depth;  // direction of depth of each frame, in the frame of reference of x; empty: the
                                       // plane of each frame that would explain most
  double false_alarm = 0.01;           // of a sequence without any flip
};
struct Flips {
  bool whole_sequence_mirrored = false;  // the best similarity is a reflection, and clearly better than a rotation
  double mirrored_z = 0;                 // difference of the two over its standard error, from blocks of frames
  std::vector<Flip> frames;              // those that flip against the majority
  RobustError error;                     // of x with these flips undone
};
// `known`: robust_error(x, truth), where the caller has it.
Flips find_flips(const Shapes& x, const Shapes& truth, const FlipOptions& options = {},
                 const RobustError* known = nullptr);
// x with those flips undone.
Shapes without_flips(const Shapes& x, const std::vector<Flip>& flips);

}  // namespace gonio::nrsfm
