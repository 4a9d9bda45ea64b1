// The detectors behind detect_board(), one for each kind of board. For sources of this folder only.
#pragma once
#include "camera/corner_detection.h"
#include "camera/grey_picture.h"

namespace gonio::camera {

Detection detect_checkerboard(const GreyPicture& picture, const Board& board, const DetectionOptions& options);
// Where no whole board is found: the largest part of it, laid where it fits (checkerboard_part.cpp). No corners: none.
Detection detect_checkerboard_part(const GreyPicture& picture, const Board& board, const DetectionOptions& options);
Detection detect_charuco(const GreyPicture& picture, const Board& board, const DetectionOptions& options);

}  // namespace gonio::camera
