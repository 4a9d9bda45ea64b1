// What to say when a board is not found, or when it does not seem to be the one that was described.
#pragma once
#include <string>
#include <vector>

#include "base/error.h"
#include "camera/corner_detection.h"

namespace gonio::camera {

// The error of a session in which no picture shows the board; `first` is one of the pictures.
Error no_board_found(const Board& board, const io::Image& first, const std::vector<Detection>& detections,
                     const std::string& place);

// A sentence where the markers found say that the board is larger than described; else empty.
std::string board_doubt(const Board& board, const std::vector<Detection>& detections);

}  // namespace gonio::camera
