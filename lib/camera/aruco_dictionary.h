// OpenCV's dictionary of a board, or of a name from marker_dictionary.h. For sources of this folder only: the type is
// OpenCV's.
#pragma once
#include <opencv2/aruco.hpp>
#include <string>

#include "camera/board.h"

namespace gonio::camera {

cv::Ptr<cv::aruco::Dictionary> aruco_dictionary(const std::string& name);
cv::Ptr<cv::aruco::Dictionary> aruco_dictionary(const Board& board);

}  // namespace gonio::camera
