// One call for every kind of board, and what can be said about its corners without any lens model: mistakes and noise.
//
// A plane homography takes the perspective out; what is left over the grid is smooth (lens, warp) plus noise. A
// polynomial over the grid of degree 4 (3 where corners are few) removes the smooth part, which radial distortion makes
// cubic to first order; the median absolute deviation of the rest gives the noise. A corner that a quadratic through
// its neighbours misses by far is a mistake, not noise.
#include "camera/corner_detection.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <map>
#include <opencv2/calib3d.hpp>

#include "camera/board_detectors.h"
#include "camera/grey_picture.h"
#include "linear/qr.h"
#include "stats/intervals.h"

namespace gonio::camera {
namespace {

constexpr int least_corners_per_term = 2;  // for a noise estimate
constexpr double gross_share = 0.12;       // of a square
constexpr double gross_sigmas = 12;
// A field that is rougher than this many times what the pixels around the corners let expect is a strong lens that few
// corners do not resolve, not noise.
constexpr double most_times_expected = 4;
constexpr double mad_to_sigma = 1.4826;  // of a normal distribution

using Field = std::map<int, Vec2>;  // by corner: deviation from the plane homography, px

Field deviations(const std::vector<Corner>& corners, const Board& board, double& square_px) {
  std::vector<cv::Point2d> from, to;
  for (const Corner& c : corners) {
    const Vec2 at = board.corner_m(c.id) * (1 / board.square_m);
    from.emplace_back(at.x, at.y);
    to.emplace_back(c.pixel.x, c.pixel.y);
  }
  const cv::Mat homography = cv::findHomography(from, to, cv::LMEDS);
  if (homography.empty()) return {};
  std::vector<cv::Point2d> mapped, shifted, steps = from;
  for (cv::Point2d& p : steps) p.x += 1;
  cv::perspectiveTransform(from, mapped, homography);
  cv::perspectiveTransform(steps, shifted, homography);
  Field field;
  std::vector<double> sides;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    field[corners[i].id] = {to[i].x - mapped[i].x, to[i].y - mapped[i].y};
    sides.push_back(cv::norm(shifted[i] - mapped[i]));
  }
  square_px = stats::median(sides);
  return field;
}

// Median absolute deviation of the field from a polynomial in columns and rows that follows lens and warp.
double noise_of(const Field& field, const Board& board) {
  const auto n = static_cast<Eigen::Index>(field.size());
  int degree = 4;
  while (degree > 1 && n < least_corners_per_term * (degree + 1) * (degree + 2) / 2) --degree;
  if (degree < 3) return 0;
  const Eigen::Index terms = (degree + 1) * (degree + 2) / 2;
  Eigen::MatrixXd a(n, terms), b(n, 2);
  Eigen::Index row = 0;
  for (const auto& [id, deviation] : field) {
    const double x = 2.0 * (id % board.corner_columns) / (board.corner_columns - 1) - 1;
    const double y = 2.0 * (id / board.corner_columns) / (board.corner_rows - 1) - 1;
    Eigen::Index column = 0;
    for (int i = 0; i <= degree; ++i) {
      for (int j = 0; i + j <= degree; ++j) a(row, column++) = std::pow(x, i) * std::pow(y, j);
    }
    b.row(row++) << deviation.x, deviation.y;
  }
  const linear::PivotedQr solver(a);
  const Eigen::MatrixXd left = b - a * solver.solve(b);
  std::vector<double> sizes;
  for (const double v : left.reshaped()) sizes.push_back(std::abs(v));
  return mad_to_sigma * stats::median(sizes) *
         std::sqrt(static_cast<double>(n) / static_cast<double>(n - solver.rank()));
}

// What a quadratic through the neighbours (up to two steps away) leaves of the corner's deviation; 0 with too few
// neighbours.
double misfit(const Field& field, const Board& board, int id) {
  const int column = id % board.corner_columns, row = id / board.corner_columns;
  Eigen::Matrix<double, Eigen::Dynamic, 6, 0, 24, 6> a(24, 6);
  Eigen::Matrix<double, Eigen::Dynamic, 2, 0, 24, 2> b(24, 2);
  int n = 0;
  for (int dy = -2; dy <= 2; ++dy) {
    for (int dx = -2; dx <= 2; ++dx) {
      if ((dx == 0 && dy == 0) || column + dx < 0 || column + dx >= board.corner_columns) continue;
      const auto found = field.find(id + dy * board.corner_columns + dx);
      if (row + dy < 0 || row + dy >= board.corner_rows || found == field.end()) continue;
      a.row(n) << 1, dx, dy, dx * dx, dx * dy, dy * dy;
      b.row(n++) << found->second.x, found->second.y;
    }
  }
  if (n < 10) return 0;
  const linear::PivotedQr solver(a.topRows(n));
  if (solver.rank() < 6) return 0;
  const Eigen::Matrix<double, 1, 2> expected = solver.solve(b.topRows(n)).row(0);
  const Vec2 here = field.at(id);
  return std::hypot(here.x - expected(0), here.y - expected(1));
}

void examine(Detection& detection, const Board& board) {
  if (detection.corners.empty()) return;
  std::vector<double> sigmas;
  for (const Corner& c : detection.corners) sigmas.push_back(c.sigma_px);
  const double expected = detection.noise_px = stats::median(sigmas);
  if (detection.corners.size() < 8) return;
  double square_px = 0;
  Field field = deviations(detection.corners, board, square_px);
  if (field.empty()) return;
  while (true) {  // the worst first: a mistake spoils its neighbours' quadratics too
    const double scatter = noise_of(field, board);
    detection.noise_px = scatter > 0 ? std::min(scatter, most_times_expected * expected) : expected;
    std::pair<double, int> worst{0, 0};
    for (const auto& entry : field) worst = std::max(worst, {misfit(field, board, entry.first), entry.first});
    if (worst.first <= std::max(gross_share * square_px, gross_sigmas * detection.noise_px)) return;
    field.erase(worst.second);
    std::erase_if(detection.corners, [&](const Corner& c) { return c.id == worst.second; });
    ++detection.gross_errors;
  }
}

}  // namespace

Detection detect_board(const io::Image& image, const Board& board, const DetectionOptions& options) {
  return detect_board(io::grey_of(image), board, options);
}

Detection detect_board(const io::GreyImage& image, const Board& board, const DetectionOptions& options) {
  // Pictures are searched side by side; threads of OpenCV's own inside each would only stand in each other's way.
  static const bool one_thread_each = (cv::setNumThreads(1), true);
  static_cast<void>(one_thread_each);
  const GreyPicture picture = grey_picture(image);
  Detection result = board.kind == BoardKind::charuco ? detect_charuco(picture, board, options)
                                                      : detect_checkerboard(picture, board, options);
  examine(result, board);
  return result;
}

}  // namespace gonio::camera
