// A reconstruction held against the truth of its sequence: every measure with every alignment asked for, flips, and how
// sure the figures are.
#pragma once
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "nrsfm/evaluate/error_intervals.h"
#include "nrsfm/sequence.h"

namespace gonio::nrsfm {

struct EvaluationOptions {
  std::vector<Measure> measures = {Measure::robust_rms, Measure::e3d, Measure::nrmse, Measure::rms};
  // Of the measures that are not robust; those have the least similarity of their own.
  std::vector<Alignment> alignments = {Alignment::none, Alignment::global_similarity, Alignment::frame_rotation,
                                       Alignment::frame_similarity};
  bool flips = true;
  bool reflection = true;  // of the robust measures' similarity
  bool centre = false;     // frame by frame, of both, before the robust measures: "centred-robust-similarity"
  std::optional<IntervalOptions> intervals = IntervalOptions{};
};
struct MeasuredError {
  Measure measure = Measure::robust_rms;
  std::string alignment;  // "none", ..., "robust-similarity"
  double value = 0;       // the truth's unit; a ratio; robust-printed: its root
  std::optional<ErrorInterval> interval;
};
struct Evaluated {
  std::vector<MeasuredError> errors;
  RobustError robust;  // root mean square
  Flips flips;
  Eigen::Index block = 0;  // of the robust error's interval
  std::vector<std::string> notes;
};
// Error(data) where sizes differ, the sequence has no truth, or the truth cannot be taken into the reconstruction's
// frame of reference.
Evaluated evaluate(const Sequence& sequence, const Reconstruction& reconstruction, const EvaluationOptions& options);

// The truth in the reconstruction's frame of reference.
Shapes truth_for(const Sequence& sequence, const Reconstruction& reconstruction, std::vector<std::string>& notes);

}  // namespace gonio::nrsfm
