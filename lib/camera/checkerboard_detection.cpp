// Plain checkerboards: all inner corners (parts: checkerboard_part.cpp), in an order that depends on the board alone
// wherever its colours allow.
//
// OpenCV's finder returns some row-wise order. It is brought to the one of board.h: right-handed as seen (no mirror
// image), the square inside the first four corners black. Where the numbers of columns and rows differ in parity this
// leaves one order; otherwise the board looks the same after half a turn, and the order whose first corner lies nearer
// to the picture's top left is taken.
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>

#include "camera/board_detectors.h"
#include "camera/checkerboard_grid.h"
#include "camera/corner_refinement.h"
#include "camera/grey_picture.h"

namespace gonio::camera {
namespace {

constexpr int search_sides_px[] = {1300, 2600, 1 << 20};

std::vector<cv::Point2f> find_grid(const GreyPicture& picture, const cv::Size& size) {
  double last_scale = 0;
  for (const int side : search_sides_px) {
    const Reduced small = reduced(picture, side);
    if (small.scale == last_scale) break;
    last_scale = small.scale;
    std::vector<cv::Point2f> points;
    bool found = cv::findChessboardCorners(small.bytes, size, points,
                                           cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE);
    if (!found) found = cv::findChessboardCornersSB(small.bytes, size, points, cv::CALIB_CB_NORMALIZE_IMAGE);
    if (!found) continue;
    for (cv::Point2f& p : points) p = small.to_full(p);
    return points;
  }
  return {};
}

CornerGrid turned_by_quarter(const CornerGrid& g) {  // only for square grids
  CornerGrid result{g.rows, g.columns, {}};
  for (int row = 0; row < result.rows; ++row) {
    for (int column = 0; column < result.columns; ++column) result.points.push_back(g.at(row, g.rows - 1 - column));
  }
  return result;
}

double mean_in_square(const cv::Mat& values, const CornerGrid& g, int column, int row) {
  return mean_inside(values,
                     {g.at(column, row), g.at(column + 1, row), g.at(column, row + 1), g.at(column + 1, row + 1)});
}

// Squares of the first one's colour minus the others: positive where the first square is the brighter one.
double brightness_of_first(const cv::Mat& values, const CornerGrid& g) {
  double sum = 0;
  int count = 0;
  for (int row = 0; row + 1 < g.rows; ++row) {
    for (int column = 0; column + 1 < g.columns; ++column, ++count) {
      sum += ((row + column) % 2 == 0 ? 1 : -1) * mean_in_square(values, g, column, row);
    }
  }
  const bool one_more = count % 2 == 1;
  return one_more ? sum - mean_in_square(values, g, 0, 0) : sum;
}

CornerGrid in_board_order(const cv::Mat& values, CornerGrid grid) {
  if (!right_handed(grid)) grid = mirrored(grid);
  std::vector<CornerGrid> turns{grid};
  CornerGrid half = grid;
  std::ranges::reverse(half.points);
  turns.push_back(half);
  if (grid.columns == grid.rows) {
    turns.push_back(turned_by_quarter(grid));
    turns.push_back(turned_by_quarter(half));
  }
  const auto rank = [&](const CornerGrid& g) {
    const cv::Point2f first = g.at(0, 0);
    return std::pair(brightness_of_first(values, g) > 0, first.x + first.y);
  };
  return *std::ranges::min_element(turns, {}, rank);
}

}  // namespace

Detection detect_checkerboard(const GreyPicture& picture, const Board& board, const DetectionOptions& options) {
  Detection result;
  CornerGrid grid{board.corner_columns, board.corner_rows,
                  find_grid(picture, {board.corner_columns, board.corner_rows})};
  if (grid.points.empty()) {
    if (options.parts) result = detect_checkerboard_part(picture, board, options);
    if (!result.corners.empty()) return result;
    result.problem = "no whole checkerboard of " + std::to_string(board.corner_columns) + " x " +
                     std::to_string(board.corner_rows) + " inner corners";
    return result;
  }
  grid = in_board_order(picture.values, grid);
  result.corners = refine(picture.values, predictions_of(grid), 1, options);
  if (result.corners.empty()) result.problem = "a checkerboard too small or too close to the edge to be refined";
  return result;
}

}  // namespace gonio::camera
