// "boards": calibration targets.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "manifest/parameter.h"

namespace gonio::manifest {

struct Board {                     // "boards"
  std::string kind;                // "checkerboard" | "charuco"
  std::vector<int> inner_corners;  // checkerboard: [columns, rows]
  std::vector<int> squares;        // charuco: [columns, rows]
  double square_m = 0;
  std::optional<double> marker_m;     // charuco
  std::string dictionary;             // charuco: "4X4_50", "5X5_1000", ...
  std::optional<bool> legacy_layout;  // charuco: the layout of OpenCV before 4.6; absent: found from the pictures
  Parameters warp;                    // board.warp: {"x_m", "y_m"} sag in metres (0: flat)
  Sigmas sigma;
  std::string dictionary_file;       // charuco: file id of a dictionary of the user's own
  std::optional<double> flatness_m;  // estimated peak to valley height over the corners
};

}  // namespace gonio::manifest
