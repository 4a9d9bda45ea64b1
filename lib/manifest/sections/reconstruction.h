// "reconstructions": of shapes that deform.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gonio::manifest {

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

}  // namespace gonio::manifest
