// See checkerboard_grid.h.
#include "camera/checkerboard_grid.h"

#include <algorithm>
#include <opencv2/imgproc.hpp>

namespace gonio::camera {

bool right_handed(const CornerGrid& g) {
  const cv::Point2f x = g.at(g.columns - 1, 0) - g.at(0, 0), y = g.at(0, g.rows - 1) - g.at(0, 0);
  return x.cross(y) > 0;
}

CornerGrid mirrored(const CornerGrid& g) {
  CornerGrid result{g.columns, g.rows, {}};
  for (int row = 0; row < g.rows; ++row) {
    for (int column = 0; column < g.columns; ++column) result.points.push_back(g.at(g.columns - 1 - column, row));
  }
  return result;
}

double mean_inside(const cv::Mat& values, const std::array<cv::Point2f, 4>& corners) {
  const cv::Point2f middle = 0.25F * (corners[0] + corners[1] + corners[2] + corners[3]);
  double sum = 0;
  for (const cv::Point2f corner : corners) {
    const cv::Point2f p = middle + 0.3F * (corner - middle);
    cv::Mat pixel;
    cv::getRectSubPix(values, cv::Size(1, 1), p, pixel, CV_32F);
    sum += 0.25 * static_cast<double>(pixel.at<float>(0, 0));
  }
  return sum;
}

std::vector<Prediction> predictions_of(const CornerGrid& grid) {
  std::vector<Prediction> predictions;
  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      const int left = std::max(0, column - 1), right = std::min(grid.columns - 1, column + 1);
      const int above = std::max(0, row - 1), below = std::min(grid.rows - 1, row + 1);
      const cv::Point2d along_columns = (grid.at(right, row) - grid.at(left, row)) * (1.0 / (right - left));
      const cv::Point2d along_rows = (grid.at(column, below) - grid.at(column, above)) * (1.0 / (below - above));
      predictions.push_back({row * grid.columns + column, grid.at(column, row), along_columns, along_rows});
    }
  }
  return predictions;
}

}  // namespace gonio::camera
