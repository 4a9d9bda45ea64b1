// The sections about shapes that deform: sequences of tracks, reconstructions of them, and how far these lie from the
// truth. A part of sections.h, which explains frames and units.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gonio::manifest {

// "sequences": points followed over frames, in a file (nrsfm/files.h says which variables).
struct TrackSequence {
  std::string file;                          // file id
  std::map<std::string, std::string> names;  // "tracks", "visible", "truth" -> variable; left out: found
  std::optional<std::int64_t> frames, points;
  std::string projection;               // "orthographic" | "perspective"
  std::string camera;                   // perspective: name in `cameras`; empty: the file's
  std::string truth_frame;              // "object" | "camera"
  std::optional<double> unit_m;         // length of the truth's unit
  std::optional<double> missing_share;  // of frames x points
  std::string tracks_from;              // "geometry" | "optical-flow" | "recording"
  std::optional<std::uint64_t> seed;
  std::map<std::string, std::string> factors;  // of an experiment -> level
  std::string source;                          // what deforms, or where it was recorded
  std::vector<std::string> notes;
};

// "reconstructions": shapes that a solver, or somebody else, made of a sequence.
struct ShapeReconstruction {
  std::string id, sequence, algorithm, file;  // file: file id; a folder of PLY files is named by its first
  std::string folder;                         // instead of `file`: PLY files, one per frame in the order of their names
  std::map<std::string, std::string> names;   // "shapes" -> variable; left out: found
  std::string frame;                          // "object" | "camera"
  std::map<std::string, double> parameters;   // of the solver, in force
  std::optional<double> estimated_share;      // of frames x points that it has a place for
  std::optional<double> reprojection_rms;     // over visible tracks, in their unit
  std::optional<std::int64_t> iterations;
  std::optional<bool> converged;
  std::optional<std::uint64_t> seed;
  std::map<std::string, std::string> factors;  // beyond the sequence's and `algorithm`
  std::vector<std::string> notes;
};

// "evaluations": of one reconstruction against the truth of its sequence.
struct EvaluatedError {
  std::string measure, alignment, unit;  // "robust-rms", "e3d", ...; "sequence-similarity", ...; "mm", "1", ...
  double value = 0;
  std::optional<double> lower, upper;  // block-bootstrap interval over frames, at Evaluation::confidence
};
struct DetectedFlip {
  std::int64_t frame = 0;  // from 0
  std::string kind;        // "depth-reversal" | "mirror"
  std::optional<double> error_before, error_after;
};
struct Evaluation {
  std::string id, sequence, algorithm;         // id: the reconstruction's
  std::map<std::string, std::string> factors;  // with the sequence's
  std::vector<EvaluatedError> errors;
  std::optional<double> confidence, block;   // of the intervals; frames that are drawn together
  std::optional<double> whisker, truncated;  // of the robust error: the truth's unit; share
  std::optional<double> estimated_share;     // of frames x points
  std::optional<double> scale;               // of the similarity that lays the reconstruction onto the truth
  std::optional<bool> mirrored;              // whether that similarity is a reflection
  std::optional<bool> converged;
  std::vector<DetectedFlip> flips;
  std::vector<std::string> notes;
  std::map<std::string, std::string> files;  // written beside it: page, aligned shapes, ...; file ids
};

}  // namespace gonio::manifest
