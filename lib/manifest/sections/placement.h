// "placements": where pieces that were scanned elsewhere stand in the world, how surely, and by what evidence.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manifest/parameter.h"
#include "manifest/pose.h"

namespace gonio::manifest {

struct MarkerPair {      // a piece's marker and what photographs show of it
  std::string marker{};  // id in markers
  std::vector<std::string> images{};
  std::vector<double> world_m{};       // where the photographs put its centre
  std::optional<double> residual_m{};  // distance of the placed marker from there,
  std::optional<double> expected_m{};  // and the rms that both covariances let expect
  std::optional<double> residual_px{};
  std::optional<double> moves_m{};  // by which the piece's markers move (rms) where this one is left out
};
struct PlacementContact {                        // what gave way under the piece, or what the piece was set down on
  std::string object{};                          // the other
  std::string how{};                             // "push" | "elastic" | "settled"
  std::optional<double> deepest_m{};             // of the push; settled: the motion
  std::optional<double> volume_m3{};             // swept
  std::vector<double> pairs{};                   // intersecting triangles before and after
  std::optional<double> gap_m{}, sigma_gap_m{};  // before: positive, it floated; negative, it sank
};
struct Placement {         // "placements"
  std::string object{};    // the piece
  std::string evidence{};  // "markers"
  std::string verdict{};   // "placed" | "ambiguous" | "mirrored" | "scaled" | "poor" | "lost"
  std::string why{};       // in words, where it was not placed
  std::optional<Pose<frame::World, frame::Object>> world_from_object{};
  // Of a small motion (rotation vector, then place) in the world at `centroid_m`, 6 x 6, row by row: rad and m.
  std::vector<double> covariance{};
  std::vector<double> centroid_m{};
  std::optional<double> rms_m{}, expected_m{};  // distance of the markers in photographs from those placed
  std::optional<double> chi_square{}, degrees{};
  std::optional<double> scale{};  // by which the piece's lengths were, or would have to be, multiplied
  Sigmas sigma{};                 // of the scale
  std::vector<MarkerPair> pairs{};
  std::vector<std::string> unseen{};                            // markers that no photograph shows
  std::vector<Pose<frame::World, frame::Object>> candidates{};  // where ambiguous: all that fit, best first
  std::vector<PlacementContact> contacts{};
};

}  // namespace gonio::manifest
