// A rectangle of corners of a plain checkerboard in a picture, row by row. For sources of this folder only: the types
// are OpenCV's.
#pragma once
#include <array>
#include <opencv2/core.hpp>
#include <vector>

#include "camera/corner_refinement.h"

namespace gonio::camera {

struct CornerGrid {
  int columns = 0, rows = 0;
  std::vector<cv::Point2f> points;
  cv::Point2f at(int column, int row) const { return points[static_cast<std::size_t>(row * columns + column)]; }
};

// Columns to the right and rows downwards make a right-handed pair, as seen from the board's front.
bool right_handed(const CornerGrid& grid);
CornerGrid mirrored(const CornerGrid& grid);  // columns in reverse

// Brightness inside a square, away from its edges; corners in any order around or across it.
double mean_inside(const cv::Mat& values, const std::array<cv::Point2f, 4>& corners);

// For refine(): of every corner, numbered as the grid lists them.
std::vector<Prediction> predictions_of(const CornerGrid& grid);

}  // namespace gonio::camera
