// Field tables of the sections about shapes that deform: sequences, reconstructions, evaluations.
#include "manifest/field_makers.h"
#include "manifest/section_tables.h"
#include "manifest/sections/evaluation.h"
#include "manifest/sections/reconstruction.h"
#include "manifest/sections/sequence.h"

namespace gonio::manifest {

const std::vector<Field<TrackSequence>>& track_sequence_fields() {
  using T = TrackSequence;
  static const std::vector<Field<T>> table{
      field("file", &T::file, "", "file id: .mat or .npz with the tracks, and the truth where it is known").needed(),
      field("names", &T::names, "", "tracks, visible, truth: the file's variables; left out: found by usual names"),
      field("frames", &T::frames, "", "how many").range(2, 1e6),
      field("points", &T::points, "", "how many are followed").range(4, 1e6),
      field("projection", &T::projection, "", "of the camera").one_of({"orthographic", "perspective"}),
      field("camera", &T::camera, "", "perspective: name of the camera; left out: as the file has it"),
      field("truth_frame", &T::truth_frame, "", "where true shapes stand: one frame for all, or each frame's camera")
          .one_of({"object", "camera"}),
      field("unit_m", &T::unit_m, "m", "length of the truth's unit; left out: not known").positive(),
      field("missing_share", &T::missing_share, "", "of frames times points that are not seen").range(0, 1),
      field("tracks_from", &T::tracks_from, "", "how the tracks came about")
          .one_of({"geometry", "optical-flow", "recording"}),
      field("seed", &T::seed, "", "of what was drawn"),
      field("factors", &T::factors, "", "factors of the experiment and their levels: deformation, path, ..."),
      field("source", &T::source, "", "what deforms, or where it was recorded"),
      field("notes", &T::notes, "", "what a reader has to know")};
  return table;
}

const std::vector<Field<ShapeReconstruction>>& shape_reconstruction_fields() {
  using T = ShapeReconstruction;
  static const std::vector<Field<T>> table{
      field("id", &T::id, "", "its name").needed(),
      field("sequence", &T::sequence, "", "what was reconstructed: name in sequences").needed(),
      field("algorithm", &T::algorithm, "", "what made it; a level of the factor algorithm").needed(),
      field("file", &T::file, "", "file id: .mat or .npz with the shapes"),
      field("folder", &T::folder, "", "instead of file: PLY files, one per frame in the order of their names"),
      field("names", &T::names, "", "shapes: the file's variable; left out: found by usual names"),
      field("frame", &T::frame, "", "where shapes stand: one frame for all, or each frame's camera")
          .one_of({"object", "camera"}),
      field("parameters", &T::parameters, "", "of the solver, as they were in force"),
      field("estimated_share", &T::estimated_share, "", "of frames times points that it has a place for").range(0, 1),
      field("reprojection_rms", &T::reprojection_rms, "", "over tracks that are seen, in their unit")
          .range(0, infinite),
      field("iterations", &T::iterations, "", "of the solver").range(0, 1e9),
      field("converged", &T::converged, "", "false: the solver ended before it stood still"),
      field("seed", &T::seed, "", "of what was drawn"),
      field("factors", &T::factors, "", "further factors and their levels"),
      field("notes", &T::notes, "", "what a reader has to know")};
  return table;
}

const std::vector<Field<EvaluatedError>>& evaluated_error_fields() {
  using T = EvaluatedError;
  static const std::vector<Field<T>> table{
      field("measure", &T::measure, "", "robust-rms, robust-printed, e3d, nrmse, rms, mean-distance").needed(),
      field("alignment", &T::alignment, "", "what was laid onto the truth before, and how freely").needed(),
      field("value", &T::value, "", "the error").needed(),
      field("unit", &T::unit, "", "m, 1 (a ratio), or \"of the truth\" where its unit is not known"),
      field("lower", &T::lower, "", "end of the interval at the evaluation's confidence"),
      field("upper", &T::upper, "", "end of the interval at the evaluation's confidence")};
  return table;
}

const std::vector<Field<DetectedFlip>>& detected_flip_fields() {
  using T = DetectedFlip;
  static const std::vector<Field<T>> table{
      field("frame", &T::frame, "", "from 0").range(0, 1e6).needed(),
      field("kind", &T::kind, "", "what would lay it onto the truth").one_of({"depth-reversal", "mirror"}).needed(),
      field("error_before", &T::error_before, "", "rms distance of the frame, in the truth's unit").range(0, infinite),
      field("error_after", &T::error_after, "", "the same with the flip undone").range(0, infinite)};
  return table;
}

const std::vector<Field<Evaluation>>& evaluation_fields() {
  using T = Evaluation;
  static const std::vector<Field<T>> table{
      field("id", &T::id, "", "of the reconstruction").needed(),
      field("sequence", &T::sequence, "", "whose truth it was held against"),
      field("algorithm", &T::algorithm, "", "what made the reconstruction"),
      field("factors", &T::factors, "", "factors of the experiment and their levels"),
      field("errors", &T::errors, "", "one for each measure and alignment"),
      field("confidence", &T::confidence, "", "of the errors' intervals").range(0, 1),
      field("block", &T::block, "", "frames that were drawn together for the intervals").range(1, 1e6),
      field("whisker", &T::whisker, "", "robust error: distances above this count as this, in the truth's unit")
          .range(0, infinite),
      field("truncated", &T::truncated, "", "robust error: share of distances above the whisker").range(0, 1),
      field("estimated_share", &T::estimated_share, "", "of frames times points that were compared").range(0, 1),
      field("scale", &T::scale, "", "truth over reconstruction, of the robust error's similarity").range(0, infinite),
      field("mirrored", &T::mirrored, "", "true: only a reflection lays the sequence onto the truth"),
      field("converged", &T::converged, "", "false: the robust error's search ended before it stood still"),
      field("flips", &T::flips, "", "frames that are mirrored although most are not"),
      field("notes", &T::notes, "", "what a reader has to know"),
      field("files", &T::files, "", "written beside it; file ids")};
  return table;
}

GONIO_RECORD(TrackSequence, track_sequence_fields);
GONIO_RECORD(ShapeReconstruction, shape_reconstruction_fields);
GONIO_RECORD(EvaluatedError, evaluated_error_fields);
GONIO_RECORD(DetectedFlip, detected_flip_fields);
GONIO_RECORD(Evaluation, evaluation_fields);

}  // namespace gonio::manifest
