// ChArUco boards: markers say which corner is which, and local homographies where to look for it.
//
// Markers (Garrido-Jurado et al. 2014) are found by OpenCV at reduced resolution first and at full resolution where
// that shows too few. Their corners are never used as measurements. Which layout the board has, current or legacy, is
// told by the markers' places. In the wrong one rows are off by one square to the left and right in turn, where the
// number of columns is even, so that a plane homography fits at most half of them; where it is odd, all are off by one
// square to the same side except one marker in every other row, which lands on the next row. A view that does not show
// those fits both layouts, and its geometry is the same.
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>

#include "camera/aruco_dictionary.h"
#include "camera/board_detectors.h"
#include "camera/corner_refinement.h"
#include "camera/grey_picture.h"
#include "camera/marker_dictionary.h"

namespace gonio::camera {
namespace {

struct Found {
  int id = 0;
  std::vector<cv::Point2f> corners;  // full picture
};

constexpr int search_sides_px[] = {1600, 3200, 1 << 20};  // longest side at which markers are sought
constexpr double enough = 0.9;                            // of the board's markers: no need to look closer
constexpr double least_marker_px = 9;
constexpr double layout_tolerance = 0.35;  // of a square: halfway between a fit and a shift by one square is 0.5
constexpr double stray_tolerance = 1.0;    // of a square: lens distortion stays below, wrong ids do not

std::vector<Found> find_markers_at(const Reduced& picture, const std::string& dictionary) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->minMarkerPerimeterRate = 4 * least_marker_px / std::max(picture.bytes.cols, picture.bytes.rows);
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;
  cv::aruco::detectMarkers(picture.bytes, aruco_dictionary(dictionary), corners, ids, parameters);
  std::vector<Found> found;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Found marker{ids[i], {}};
    for (const cv::Point2f& p : corners[i]) marker.corners.emplace_back(picture.to_full(p));
    found.push_back(std::move(marker));
  }
  std::ranges::sort(found, [](const Found& a, const Found& b) { return a.id < b.id; });
  return found;
}

std::vector<Found> find_markers(const GreyPicture& picture, const std::string& dictionary, std::size_t on_board) {
  std::vector<Found> best;
  double last_scale = 0;
  for (const int side : search_sides_px) {
    const Reduced small = reduced(picture, side);
    if (small.scale == last_scale) break;
    last_scale = small.scale;
    std::vector<Found> found = find_markers_at(small, dictionary);
    if (found.size() > best.size()) best = std::move(found);
    if (static_cast<double>(best.size()) >= enough * static_cast<double>(on_board)) break;
  }
  return best;
}

using MarkerPlaces = std::map<int, std::array<Vec2, 4>>;  // board frame, by id

MarkerPlaces places_of(Board board, bool legacy) {
  if (board.layout_matters()) board.legacy = legacy;
  MarkerPlaces places;
  for (const Marker& marker : markers(board)) places[marker.id] = marker.corners_m;
  return places;
}

// Distance of every marker from where the best plane homography puts it, in squares; infinite where none exists.
std::vector<double> misfits(const std::vector<Found>& found, const MarkerPlaces& places, double square_m) {
  std::vector<cv::Point2f> pixels, board;
  for (const Found& marker : found) {
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec2 at = places.at(marker.id)[k];
      pixels.push_back(marker.corners[k]);
      board.emplace_back(static_cast<float>(at.x / square_m), static_cast<float>(at.y / square_m));
    }
  }
  std::vector<double> result(found.size(), std::numeric_limits<double>::infinity());
  if (pixels.size() < 4) return result;
  const cv::Mat board_from_pixel = cv::findHomography(pixels, board, cv::RANSAC, layout_tolerance);
  if (board_from_pixel.empty()) return result;
  std::vector<cv::Point2f> mapped;
  cv::perspectiveTransform(pixels, mapped, board_from_pixel);
  for (std::size_t i = 0; i < found.size(); ++i) {
    cv::Point2f mean(0, 0);
    for (std::size_t k = 4 * i; k < 4 * i + 4; ++k) mean += (mapped[k] - board[k]) * 0.25F;
    result[i] = std::hypot(mean.x, mean.y);
  }
  return result;
}

int votes(const std::vector<double>& misfit) {
  return static_cast<int>(std::ranges::count_if(misfit, [](double d) { return d < layout_tolerance; }));
}

// Prediction::bare: black squares have no markers, and the top-left square of the current layout is black.
int bare_squares(const Board& board, int corner, bool legacy) {
  const int row = corner / board.corner_columns, column = corner % board.corner_columns;
  const bool first_is_black = !(board.layout_matters() && legacy);
  return ((row + column) % 2 == 0) == first_is_black ? 1 : -1;
}

// The homography of the markers nearest to `corner`, of which one at least must touch it.
std::vector<Prediction> predict_corners(const std::vector<Found>& found, const MarkerPlaces& places,
                                        const Board& board, bool legacy) {
  std::vector<Prediction> predictions;
  for (int id = 0; id < board.corners(); ++id) {
    const Vec2 corner = board.corner_m(id);
    std::vector<std::pair<double, const Found*>> near;
    for (const Found& marker : found) {
      const auto& at = places.at(marker.id);
      const Vec2 middle = (at[0] + at[2]) * 0.5;
      near.emplace_back(norm(middle - corner) / board.square_m, &marker);
    }
    std::ranges::sort(near, [](const auto& a, const auto& b) {
      return std::pair(a.first, a.second->id) < std::pair(b.first, b.second->id);
    });
    if (near.empty() || near.front().first > 0.8) continue;  // the markers that touch it are 0.71 squares away
    std::vector<cv::Point2f> from, to;
    for (std::size_t i = 0; i < std::min<std::size_t>(4, near.size()) && near[i].first < 3; ++i) {
      for (std::size_t k = 0; k < 4; ++k) {
        const Vec2 at = (places.at(near[i].second->id)[k] - corner) * (1 / board.square_m);
        from.emplace_back(static_cast<float>(at.x), static_cast<float>(at.y));
        to.push_back(near[i].second->corners[k]);
      }
    }
    const cv::Mat homography = cv::findHomography(from, to, 0);
    if (homography.empty()) continue;
    const std::vector<cv::Point2f> ask{{0, 0}, {0.5F, 0}, {-0.5F, 0}, {0, 0.5F}, {0, -0.5F}};
    std::vector<cv::Point2f> p;
    cv::perspectiveTransform(ask, p, homography);
    predictions.push_back({id, p[0], p[1] - p[2], p[3] - p[4], bare_squares(board, id, legacy)});
  }
  return predictions;
}

}  // namespace

Detection detect_charuco(const GreyPicture& picture, const Board& board, const DetectionOptions& options) {
  Detection result;
  std::vector<Found> found = find_markers(picture, board.dictionary, markers(board).size());
  const MarkerPlaces current = places_of(board, false), legacy = places_of(board, true);
  result.foreign_markers =
      static_cast<int>(std::erase_if(found, [&](const Found& marker) { return !current.contains(marker.id); }));
  // A marker seen twice cannot be trusted either time.
  std::erase_if(found, [&](const Found& marker) { return std::ranges::count(found, marker.id, &Found::id) > 1; });
  std::vector<double> misfit = misfits(found, current, board.square_m);
  result.layout_votes[0] = votes(misfit);
  result.legacy = board.legacy.value_or(false);
  if (board.layout_matters()) {
    std::vector<double> misfit_legacy = misfits(found, legacy, board.square_m);
    result.layout_votes[1] = votes(misfit_legacy);
    if (!board.legacy) result.legacy = result.layout_votes[1] > result.layout_votes[0];
    if (result.legacy) misfit = std::move(misfit_legacy);
  }
  std::vector<Found> trusted;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (misfit[i] < stray_tolerance) trusted.push_back(found[i]);
  }
  result.markers = static_cast<int>(trusted.size());
  if (trusted.empty()) {
    result.problem = "no marker of " + board.dictionary + " that belongs to the board";
    return result;
  }
  const double clear = 0.5 * (1 - board.marker_m / board.square_m);
  result.corners =
      refine(picture.values, predict_corners(trusted, result.legacy ? legacy : current, board, result.legacy), clear, options);
  if (result.corners.empty()) result.problem = "markers, but no corner between them could be refined";
  return result;
}

DictionaryGuess guess_dictionary(const io::Image& image) {
  const io::GreyImage grey = io::grey_of(image);
  const GreyPicture picture = grey_picture(grey);
  DictionaryGuess best;
  for (const char* family : {"4X4_1000", "5X5_1000", "6X6_1000", "7X7_1000", "ARUCO_ORIGINAL"}) {
    const std::vector<Found> found = find_markers_at(reduced(picture, 3200), family);
    if (static_cast<int>(found.size()) <= best.markers) continue;
    best = {family, static_cast<int>(found.size()), found.back().id};
  }
  return best;
}

}  // namespace gonio::camera
