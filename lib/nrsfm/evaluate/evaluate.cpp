// See evaluate.h.
#include "nrsfm/evaluate/evaluate.h"

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "base/text.h"

namespace gonio::nrsfm {
namespace {

// Directions of depth in the reconstruction's frame: z of each camera.
std::vector<Eigen::Vector3d> depths_of(const Reconstruction& r) {
  std::vector<Eigen::Vector3d> out;
  if (r.frame == ShapeFrame::camera)
    return std::vector<Eigen::Vector3d>(static_cast<std::size_t>(r.frames()), Eigen::Vector3d::UnitZ());
  for (const auto& rows : r.rotations)
    out.push_back(rows.row(0).transpose().cross(rows.row(1).transpose()).normalized());
  return out;
}

Aligned laid(const Shapes& x, const Shapes& truth, const Similarity& s) {
  Aligned a{Shapes(x.rows(), x.cols()), truth, {s}, {}};
  for (Eigen::Index f = 0; f < x.rows() / 3; ++f) shape_of(a.shapes, f) = moved(s, shape_of(x, f));
  return a;
}

bool is_robust(Measure m) {
  return m == Measure::robust_rms || m == Measure::robust_printed;
}

double plain_value(Measure measure, const Aligned& aligned) {
  switch (measure) {
    case Measure::e3d: return e3d(aligned);
    case Measure::nrmse: return nrmse(aligned);
    case Measure::rms: return rmse(aligned);
    default: return mean_distance(aligned);
  }
}

void add(Evaluated& out, Measure measure, const std::string& alignment, double value, const Aligned& aligned,
         const EvaluationOptions& options) {
  MeasuredError error{measure, alignment, value, {}};
  if (options.intervals) error.interval = error_interval(aligned, measure, *options.intervals);
  if (error.interval) {  // of errors that are rounding, the two values differ
    error.interval->lower = std::min(error.interval->lower, value);
    error.interval->upper = std::max(error.interval->upper, value);
  }
  if (error.interval && measure == Measure::robust_rms) out.block = error.interval->block;
  out.errors.push_back(std::move(error));
}

void note_result(Evaluated& out, const Shapes& x) {
  if (std::ranges::any_of(out.errors,
                          [](const MeasuredError& e) { return e.interval && !std::isfinite(e.interval->upper); }))
    out.notes.push_back("no intervals: they need ten frames and three blocks of them");
  if (out.flips.whole_sequence_mirrored)
    out.notes.push_back("the whole sequence is mirrored: only a reflection lays it onto the truth");
  if (!out.flips.frames.empty())
    out.notes.push_back(
        std::to_string(out.flips.frames.size()) + " of " + std::to_string(x.rows() / 3) +
        (out.flips.frames.size() == 1 ? " frames is flipped; without" : " frames are flipped; without") +
        " that the robust error would be " + format("%.4g", out.flips.error.value) + " instead of " +
        format("%.4g", out.robust.value));
  if (out.robust.estimated < 1)
    out.notes.push_back(format("%.1f", 100 * (1 - out.robust.estimated)) +
                        " % of the points are not estimated and do not count");
  if (!out.robust.converged) out.notes.push_back("the robust error's search ended before it stood still");
}

}  // namespace

Shapes truth_for(const Sequence& sequence, const Reconstruction& r, std::vector<std::string>& notes) {
  if (!sequence.truth)
    throw Error(Exit::data, sequence.name, "has no truth", "give a file with S, or name its variable");
  if (sequence.truth_frame == r.frame) return *sequence.truth;
  if (r.frame == ShapeFrame::camera) {
    if (sequence.cameras.empty())
      throw Error(Exit::data, sequence.name,
                  "has its truth in one frame of reference, the reconstruction stands in each camera's",
                  "store the cameras (R, T) in the sequence");
    return in_cameras(*sequence.truth, sequence.cameras);
  }
  if (sequence.cameras.empty()) {
    notes.push_back(
        "the truth stands in each frame's camera, the reconstruction in one frame of reference: compared as they are");
    return *sequence.truth;
  }
  Shapes out(sequence.truth->rows(), sequence.truth->cols());
  for (Eigen::Index f = 0; f < out.rows() / 3; ++f) {
    const CameraFromObject& camera = sequence.cameras[static_cast<std::size_t>(f)];
    shape_of(out, f) = camera.rotation.transpose() * (shape_of(*sequence.truth, f).colwise() - camera.translation);
  }
  return out;
}

Evaluated evaluate(const Sequence& sequence, const Reconstruction& r, const EvaluationOptions& options) {
  Evaluated out;
  const Shapes plain = truth_for(sequence, r, out.notes);
  const Aligned centred = options.centre ? align(r.shapes, plain, Alignment::none) : Aligned{r.shapes, plain, {}, {}};
  const Shapes &x = centred.shapes, &truth = centred.truth;
  out.robust = robust_error(x, truth, {.reflection = options.reflection});
  if (options.flips)
    out.flips = find_flips(x, truth, {.depth = depths_of(r)}, options.reflection ? &out.robust : nullptr);
  for (const Measure measure : options.measures) {
    if (!is_robust(measure)) continue;
    const bool printed = measure == Measure::robust_printed;
    const RobustError e =
        printed ? robust_error(x, truth, {.mean = RobustMean::printed, .reflection = options.reflection}) : out.robust;
    add(out, measure, options.centre ? "centred-robust-similarity" : "robust-similarity", e.value,
        laid(x, truth, e.alignment), options);
  }
  for (const Alignment alignment : options.alignments) {
    if (std::ranges::all_of(options.measures, is_robust)) break;
    const Aligned aligned = align(x, truth, alignment);
    for (const Measure measure : options.measures)
      if (!is_robust(measure))
        add(out, measure, alignment_names()[static_cast<std::size_t>(alignment)], plain_value(measure, aligned),
            aligned, options);
  }
  note_result(out, x);
  return out;
}

}  // namespace gonio::nrsfm
