// The detectors behind detect_board(), one for each kind of board. For sources of this folder only.
#pragma once
#include "camera/corner_detection.h"
#include "camera/grey_picture.h"

namespace gonio::camera {

Detection detect_checkerboard(const GreyPicture& picture, const Board& board, const DetectionOptions& options);
Detection detect_charuco(const GreyPicture& picture, const Board& board, const DetectionOptions& options);

}  // namespace gonio::camera
