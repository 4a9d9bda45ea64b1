// Where a board's corners lie in a projector's pixels: a projector is a camera that light leaves, and calibrated as one
// from corners that a camera found and the codes about them.
//
// Each coordinate of the projector is a polynomial of the second degree in the camera's pixel about a corner, fitted to
// the pixels within the four squares around it by their variances, robustly: of the black squares' pixels as many as
// are told, none within a blur of the squares' edges, where the brighter side's light drowns the other's. Moreno &
// Taubin (3DIMPVT 2012) fit a homography, which lenses bend: its middle is off by the half of what the distortion's
// second derivative makes over the window; the polynomial's is not. The corner's place is its value at the camera's
// corner; the covariance is the fit's, and the camera's own error goes along with the slope (camera/carried_corners.h).
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "camera/board.h"
#include "camera/corner_detection.h"
#include "scan/decode.h"

namespace gonio::scan {

struct LitCorner {
  Vec2 place;                     // of the projector
  std::array<double, 4> slope{};  // d place / d the camera's pixel, row-major
  std::array<double, 3> own{};    // xx, xy, yy, px^2
  std::size_t pixels = 0;         // that told it
};

// `along_columns`, `along_rows`: a square's sides there, in the camera's pixels. Nothing where too few pixels are told.
std::optional<LitCorner> lit_corner(const Codes& codes, Vec2 corner, Vec2 along_columns, Vec2 along_rows);

struct CameraCorners {
  std::size_t camera = 0;  // camera::LookedUp::At
  const camera::Detection* detection = nullptr;
  const Codes* codes = nullptr;
};

struct ProjectorCorners {
  camera::Detection detection;  // `problem`: why it has few corners
  int turned_over = 0;          // corners about which the projector's pixels run the other way round than the camera's
  bool exchanged = false;       // its columns run along the camera's rows
};

// Corners that several cameras saw are their mean by the inverse of their covariances; those that contradict each other
// are left out.
ProjectorCorners projector_corners(const std::vector<CameraCorners>& cameras, const camera::Board& board);

}  // namespace gonio::scan
