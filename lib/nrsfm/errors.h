// How far a reconstruction lies from the truth: the measures of the literature, each named together with its alignment.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "nrsfm/alignment.h"
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

// Jensen et al. 2018, section 4: distances above E3 + 1.5 (E3 - E1) (Tukey's whisker; E1, E3 the quartiles) count as
// that much. Their equation 3 has the root of the mean of t; a root mean SQUARE, as its name and unit say, has t^2.
enum class RobustMean { root_mean_square, printed };
struct RobustOptions {
  RobustMean mean = RobustMean::root_mean_square;
  bool reflection = true;
  int most_iterations = 200;
};
struct RobustError {
  double value = 0;      // the truth's unit (its root where `printed`)
  double whisker = 0;    // E3 + w at the minimum
  double truncated = 0;  // share of the points
  double estimated = 1;  // share of frames x points that the reconstruction estimates
  Similarity alignment;  // the one similarity for the whole sequence
  int iterations = 0;
  bool converged = false;
};
// The least over scale, rotation (with reflection) and translation of the whole sequence, by Levenberg-Marquardt from
// Procrustes starts. The whisker moves with the distances; each step holds it and is accepted only where the true
// measure falls.
RobustError robust_error(const Shapes& x, const Shapes& truth, const RobustOptions& options = {});

// Frames that are upside down although the rest is not: the depth of a frame, or the whole frame, mirrored.
enum class FlipKind { none, depth_reversal, mirror };
struct Flip {
  Eigen::Index frame = 0;
  FlipKind kind = FlipKind::none;
  double error_before = 0, error_after = 0;  // rms distance after the sequence's similarity; and with the flip undone
};
struct Flips {
  bool whole_sequence_mirrored = false;  // the best similarity is a reflection, and clearly better than a rotation
  std::vector<Flip> frames;              // those that flip against the majority
};
Flips find_flips(const Shapes& x, const Shapes& truth);

}  // namespace gonio::nrsfm
