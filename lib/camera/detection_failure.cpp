// Remedies are found by trying: other dictionaries, and the usual confusion of squares with inner corners.
#include "camera/detection_failure.h"

#include <algorithm>

#include "camera/marker_dictionary.h"

namespace gonio::camera {
namespace {

constexpr int worth_naming = 3;         // markers of another dictionary in one picture; fewer may be chance
constexpr double doubtful_share = 0.1;  // of markers that the board does not have

std::string remedy_charuco(const Board& board, const io::Image& picture) {
  const DictionaryGuess guess = guess_dictionary(picture);
  const std::string family = board.dictionary.substr(0, board.dictionary.find('_'));
  if (guess.markers < worth_naming || guess.family.starts_with(family)) {
    return "check focus and light, and that the photographs show this board";
  }
  const std::string guessed = guess.family.substr(0, guess.family.find('_'));
  std::string smallest = guess.family;
  for (const std::string& name : dictionary_names()) {
    if (!name.starts_with(guessed) || dictionary_size(name) <= guess.largest_id) continue;
    if (dictionary_size(name) < dictionary_size(smallest)) smallest = name;
  }
  return "the first photograph shows " + std::to_string(guess.markers) + " markers of " + smallest + " (largest id " +
         std::to_string(guess.largest_id) + "): give that dictionary";
}

std::string remedy_checkerboard(const Board& board, const io::Image& picture, std::ptrdiff_t parts) {
  for (const int d : {-1, 1}) {
    Board other = board;
    other.corner_columns += d;
    other.corner_rows += d;
    if (std::min(other.corner_columns, other.corner_rows) < 2) continue;
    if (detect_board(picture, other, {}).corners.empty()) continue;
    return "the first photograph shows " + std::to_string(other.corner_columns) + " x " +
           std::to_string(other.corner_rows) + " inner corners: count corners between squares, not squares";
  }
  if (parts > 0)
    return std::to_string(parts) +
           " of them show less of one: give the number of inner corners that can be seen, or "
           "photograph the whole board once";
  return "count inner corners, not squares; the whole board must be in the picture with a white margin";
}

}  // namespace

Error no_board_found(const Board& board, const io::Image& first, const std::vector<Detection>& detections,
                     const std::string& place) {
  const std::string count = std::to_string(detections.size()) + (detections.size() == 1 ? " picture" : " pictures");
  if (board.kind == BoardKind::checkerboard) {
    return {Exit::data, place,
            "none of " + count + " shows a whole checkerboard of " + std::to_string(board.corner_columns) + " x " +
                std::to_string(board.corner_rows) + " inner corners",
            remedy_checkerboard(board, first, std::ranges::count_if(detections, &Detection::part))};
  }
  const std::string doubt = board_doubt(board, detections);
  return {Exit::data, place,
          "none of " + count + " shows a ChArUco board of " + std::to_string(board.square_columns()) + " x " +
              std::to_string(board.square_rows()) + " squares with markers of " + board.dictionary,
          doubt.empty() ? remedy_charuco(board, first) : doubt};
}

std::string board_doubt(const Board& board, const std::vector<Detection>& detections) {
  int foreign = 0, own = 0;
  for (const Detection& d : detections) {
    foreign += d.foreign_markers;
    own += d.markers;
  }
  if (foreign < worth_naming || foreign < doubtful_share * (foreign + own)) return {};
  return std::to_string(foreign) + " of " + std::to_string(foreign + own) + " markers have numbers that a board of " +
         std::to_string(board.square_columns()) + " x " + std::to_string(board.square_rows()) +
         " squares lacks; the board is larger than described, or another one";
}

}  // namespace gonio::camera
