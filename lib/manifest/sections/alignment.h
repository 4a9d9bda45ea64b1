// "outlines" and "alignments": where photographs show the rims of objects and of their shadows, and what follows of
// poses, lamps and sizes. Written by align; explain asks what the rims do not follow.
#pragma once
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "manifest/parameter.h"
#include "manifest/pose.h"

namespace gonio::manifest {

// A rim in a photograph: of an object, or of its shadow on the ground. `mask` is what was stated or found: pixels above
// a half belong to it, and the rim runs between them. `file` is a table of the rim's points: align(1), FILES.
struct Outline {
  std::string image{}, object{};
  std::string kind{};   // "object" | "shadow"
  std::string light{};  // of a shadow: the lamp that casts it
  std::string mask{}, file{};
  std::optional<std::int64_t> points{}, left_out{};  // of the rim; that the loss counts for nothing
  std::optional<double> rms_px{};                    // normal offset of the counted points from the aligned model
  std::optional<double> mean_px{};                   // of these, outwards: what is left of a bias
  std::optional<double> explained{};                 // share of the model's rim that has points beside it
};
struct AlignedLight {
  std::string light{};
  std::vector<std::string> images{};                  // of a light that a tool carries: taken while it stood there
  std::vector<double> position_m{}, covariance_m2{};  // world; 3 x 3, row by row
  std::optional<double> radius_m{};                   // from the width of penumbrae
  Sigmas sigma{};                                     // of radius_m
};
struct AlignedCamera {
  std::string camera{};
  std::vector<std::string> images{};
  std::optional<Pose<frame::World, frame::Camera>> world_from_camera{};
  std::vector<double> covariance{};  // 6 x 6, of a small motion in the world at the camera: rad, then m
  std::optional<double> focal_factor{};
  Sigmas sigma{};  // of focal_factor
};
struct AlignmentCandidate {
  std::optional<Pose<frame::World, frame::Object>> world_from_object{};
  double rms_px = 0, explained = 0;
};
// What pictures, beside rims, say of where things are: align --picture.
struct AlignedPictures {
  std::string verdict{};  // "taken" | "refused": the rims' answer stands
  std::string why{};      // of what was refused
  std::int64_t photographs = 0, pixels = 0;
  double independent = 0;                              // values that pixels amount to
  double correlation_px = 0;                           // side of a square whose errors are one error
  double relative_error = 0, relative_error_rims = 0;  // rms left over rms seen; at the rims' answer
  double chi2 = 0, chi2_limit = 0;                     // of the move, by the rims' covariance
  std::int64_t numbers = 0;
  double move_px = 0, sigma_px = 0;  // rms over the rims' points: of the move, and what rims state
  std::optional<Pose<frame::World, frame::Object>> world_from_object{};
  std::vector<double> covariance{};  // as Alignment's, about the middle of the object there
};
struct Alignment {
  std::string object{};
  std::string verdict{};  // "found" | "ambiguous" | "mirrored" | "lost"
  std::string why{};      // in words, where it was not found
  std::optional<Pose<frame::World, frame::Object>> world_from_object{};
  // Of a small motion (rotation vector, then place) in the world at `centre_m`, 6 x 6, row by row: rad and m.
  std::vector<double> covariance{};
  std::vector<double> centre_m{};
  std::vector<double> scale{};  // along the mesh's axes, about its origin
  Sigmas sigma{};               // of scale
  double rms_px = 0;            // of all points that count
  double sigma_px = 0;          // of one point, by what is left over
  double correlation_px = 0;    // along the rim, over which errors are alike: the sum of their autocorrelation
  std::optional<double> explained{};
  std::vector<std::string> open{};  // directions that no rim holds, by name: turning about ..., size against distance
  std::vector<AlignmentCandidate> candidates{};
  std::vector<AlignedLight> lights{};
  std::vector<AlignedCamera> cameras{};
  std::optional<AlignedPictures> pictures{};
};

}  // namespace gonio::manifest
