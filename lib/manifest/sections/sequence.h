// "sequences": points of shapes that deform, followed over frames.
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

}  // namespace gonio::manifest
