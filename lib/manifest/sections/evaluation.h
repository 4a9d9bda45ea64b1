// "evaluations": how far reconstructions lie from the truth.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gonio::manifest {

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
