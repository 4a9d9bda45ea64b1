// ChArUco boards: markers say which corner is which, and local homographies where to look for it.
//
// Markers (Garrido-Jurado et al. 2014) are found by OpenCV at reduced resolution first and at full resolution where
// that hides some. Their corners are never used as measurements. Which layout the board has, current or legacy, is
// told by the markers' places. In the wrong one rows are off by one square to the left and right in turn, where the
// number of columns is even, so that a plane homography fits at most half of them; where it is odd, all are off by one
// square to the same side except one marker in every other row, which lands on the next row. A view that does not show
// those fits both layouts, and its geometry is the same.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <opencv2/aruco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <set>

#include "camera/aruco_dictionary.h"
#include "camera/board_detectors.h"
#include "camera/corner_growth.h"
#include "camera/corner_refinement.h"
#include "camera/grey_picture.h"
#include "camera/marker_dictionary.h"
#include "stats/intervals.h"

namespace gonio::camera {
namespace {

struct Found {
  int id = 0;
  std::vector<cv::Point2f> corners;  // full picture
};

// Longest sides at which markers are sought; pictures that are hardly larger are not reduced.
constexpr int search_sides_px[] = {1000, 2000, 4000, 1 << 20}, small_picture_px = 1600;
constexpr double enough = 0.9;                // of the markers in sight: no need to look closer
constexpr double comfortable_marker_px = 26;  // found wherever it is not covered
constexpr std::size_t least_trusted = 2;
constexpr std::size_t least_markers = 3;  // that say where the others are
constexpr double least_marker_px = 9;
constexpr double layout_tolerance = 0.35;  // of a square: halfway between a fit and a shift by one square is 0.5
constexpr double stray_tolerance = 1.0;    // of a square: lens distortion stays below, wrong ids do not

std::vector<Found> find_markers_at(const Reduced& picture, const cv::Ptr<cv::aruco::Dictionary>& dictionary) {
  const auto parameters = cv::aruco::DetectorParameters::create();
  parameters->minMarkerPerimeterRate = 4 * least_marker_px / std::max(picture.bytes.cols, picture.bytes.rows);
  // Two sizes of window instead of three: what either misses at one scale, the next scale finds.
  parameters->adaptiveThreshWinSizeMin = 7;
  parameters->adaptiveThreshWinSizeMax = 23;
  parameters->adaptiveThreshWinSizeStep = 16;
  parameters->cornerRefinementMethod = cv::aruco::CORNER_REFINE_NONE;
  std::vector<int> ids;
  std::vector<std::vector<cv::Point2f>> corners;
  cv::aruco::detectMarkers(picture.bytes, dictionary, corners, ids, parameters);
  std::vector<Found> found;
  for (std::size_t i = 0; i < ids.size(); ++i) {
    Found marker{ids[i], {}};
    for (const cv::Point2f& p : corners[i]) marker.corners.emplace_back(picture.to_full(p));
    found.push_back(std::move(marker));
  }
  std::ranges::sort(found, [](const Found& a, const Found& b) { return a.id < b.id; });
  return found;
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

// Which markers belong to the board, in the layout that more of them fit.
struct Sight {
  std::vector<Found> trusted;
  std::size_t own = 0;  // with ids of the board
  int foreign = 0;
  std::array<int, 2> votes{};
  bool legacy = false;
};

Sight sight_of(std::vector<Found> found, const Board& board, const std::array<MarkerPlaces, 2>& places) {
  Sight sight;
  sight.foreign =
      static_cast<int>(std::erase_if(found, [&](const Found& marker) { return !places[0].contains(marker.id); }));
  // A marker seen twice cannot be trusted either time.
  const std::vector<Found> all = found;
  std::erase_if(found, [&](const Found& marker) { return std::ranges::count(all, marker.id, &Found::id) > 1; });
  sight.own = found.size();
  std::vector<double> misfit = misfits(found, places[0], board.square_m);
  sight.votes[0] = votes(misfit);
  sight.legacy = board.legacy.value_or(false);
  if (board.layout_matters()) {
    std::vector<double> misfit_legacy = misfits(found, places[1], board.square_m);
    sight.votes[1] = votes(misfit_legacy);
    if (!board.legacy) sight.legacy = sight.votes[1] > sight.votes[0];
    if (sight.legacy) misfit = std::move(misfit_legacy);
  }
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (misfit[i] < stray_tolerance) sight.trusted.push_back(found[i]);
  }
  return sight;
}

// How many markers that were not found lie inside the picture and are so small at this scale that a closer look may
// find them: the others are covered, or there is nothing more to see of them.
int hidden_by_scale(const Sight& sight, const MarkerPlaces& places, const GreyPicture& picture, double scale) {
  std::vector<cv::Point2f> board, pixels;
  for (const Found& marker : sight.trusted) {
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec2 at = places.at(marker.id)[k];
      board.emplace_back(static_cast<float>(at.x), static_cast<float>(at.y));
      pixels.push_back(marker.corners[k]);
    }
  }
  const cv::Mat homography = cv::findHomography(board, pixels, 0);
  if (homography.empty()) return static_cast<int>(places.size());
  int hidden = 0;
  for (const auto& [id, corners] : places) {
    if (std::ranges::count(sight.trusted, id, &Found::id) > 0) continue;
    std::vector<cv::Point2f> from, to;
    for (const Vec2 at : corners) from.emplace_back(static_cast<float>(at.x), static_cast<float>(at.y));
    cv::perspectiveTransform(from, to, homography);
    const cv::Rect2f frame(0, 0, static_cast<float>(picture.bytes.cols), static_cast<float>(picture.bytes.rows));
    const bool inside = std::ranges::all_of(to, [&](const cv::Point2f& p) { return frame.contains(p); });
    const double side = std::sqrt(cv::contourArea(to)) / scale;
    if (inside && side < comfortable_marker_px) ++hidden;
  }
  return hidden;
}

// At one size of the picture after the other, until a closer look promises nothing.
Sight search(const GreyPicture& picture, const Board& board, const std::array<MarkerPlaces, 2>& places) {
  const auto dictionary = aruco_dictionary(board);
  Sight best;
  double last_scale = 0;
  for (const int side : search_sides_px) {
    if (side < small_picture_px && std::max(picture.bytes.cols, picture.bytes.rows) <= small_picture_px) continue;
    const Reduced small = reduced(picture, side);
    if (small.scale == last_scale) break;
    last_scale = small.scale;
    Sight sight = sight_of(find_markers_at(small, dictionary), board, places);
    if (sight.trusted.size() >= best.trusted.size()) best = std::move(sight);
    if (best.trusted.size() < least_markers) continue;
    const double seen = static_cast<double>(best.trusted.size());
    const int hidden = hidden_by_scale(best, places[best.legacy ? 1 : 0], picture, small.scale);
    if (seen >= enough * (seen + hidden)) break;
  }
  return best;
}

// Prediction::bare: black squares have no markers, and the top-left square of the current layout is black.
int bare_squares(const Board& board, int corner, bool legacy) {
  const int row = corner / board.corner_columns, column = corner % board.corner_columns;
  const bool first_is_black = !(board.layout_matters() && legacy);
  return ((row + column) % 2 == 0) == first_is_black ? 1 : -1;
}

// The homography of the markers nearest to `corner`, of which one at least must touch it.
std::vector<Prediction> predict_corners(const std::vector<Found>& found, const MarkerPlaces& places, const Board& board,
                                        bool legacy) {
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
    cv::Mat board_from_pixel;  // by the nearest marker: the others count where they agree with it
    for (std::size_t i = 0; i < std::min<std::size_t>(4, near.size()) && near[i].first < 3; ++i) {
      std::vector<cv::Point2f> at_board, at_pixel = near[i].second->corners, mapped;
      for (const Vec2 at : places.at(near[i].second->id)) {
        const Vec2 there = (at - corner) * (1 / board.square_m);
        at_board.emplace_back(static_cast<float>(there.x), static_cast<float>(there.y));
      }
      if (i == 0) board_from_pixel = cv::getPerspectiveTransform(at_pixel, at_board);
      cv::perspectiveTransform(at_pixel, mapped, board_from_pixel);
      if (cv::norm(mapped[0] + mapped[2] - at_board[0] - at_board[2]) > 2 * layout_tolerance) continue;
      from.insert(from.end(), at_board.begin(), at_board.end());
      to.insert(to.end(), at_pixel.begin(), at_pixel.end());
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
  const std::array<MarkerPlaces, 2> places{places_of(board, false), places_of(board, true)};
  const Sight sight = search(picture, board, places);
  result.foreign_markers = sight.foreign;
  result.layout_votes = sight.votes;
  result.legacy = sight.legacy;
  result.markers = static_cast<int>(sight.trusted.size());
  if (sight.trusted.empty()) {
    result.problem = "no marker of " + board.dictionary + " that belongs to the board";
    return result;
  }
  if (sight.trusted.size() < least_trusted) {  // one alone may be chance: of a mirrored board, or of another one
    result.problem = "only " + std::to_string(sight.trusted.size()) + " of " + std::to_string(sight.own) +
                     " markers of " + board.dictionary + " lie where the board has them";
    return result;
  }
  const double clear = 0.5 * (1 - board.marker_m / board.square_m);
  const auto predictions = predict_corners(sight.trusted, places[sight.legacy ? 1 : 0], board, sight.legacy);
  result.corners = refine(picture.values, predictions, clear, options);
  // Corners whose own markers are cut off, blurred or covered.
  Growth growth;
  growth.clear_share = clear, growth.bare = bare_squares, growth.legacy = sight.legacy;
  grow(picture, board, growth, options, result.corners);
  if (result.corners.empty()) result.problem = "markers, but no corner between them could be refined";
  return result;
}

DictionaryGuess guess_dictionary(const io::Image& image) {
  const io::GreyImage grey = io::grey_of(image);
  const GreyPicture picture = grey_picture(grey);
  DictionaryGuess best;
  for (const char* family : {"4X4_1000", "5X5_1000", "6X6_1000", "7X7_1000", "ARUCO_ORIGINAL"}) {
    const std::vector<Found> found = find_markers_at(reduced(picture, 3200), aruco_dictionary(std::string(family)));
    if (static_cast<int>(found.size()) <= best.markers) continue;
    best = {family, static_cast<int>(found.size()), found.back().id};
  }
  return best;
}

}  // namespace gonio::camera
