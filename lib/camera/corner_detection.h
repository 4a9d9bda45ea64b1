// Corners of a calibration board in a photograph: pixels, pixel centres at integers, numbered as in board.h.
//
// The board is searched at reduced resolution; every corner is then refined on the full picture as the crossing of two
// blurred edges (corner_refinement.h), which fixes its position whatever the search's own convention; OpenCV 4.6
// returns ChArUco corners with a shift of about half a pixel, which this avoids. Does not know lenses: prediction is
// local.
#pragma once
#include <array>
#include <memory>
#include <string>
#include <vector>

#include "camera/board.h"
#include "geom/vector.h"
#include "io/grey.h"
#include "io/image.h"

namespace gonio::camera {

struct DetectionOptions {
  // How far from a corner along the edges its refinement looks. 0: 0.42 of the local side of a square, 2.5 to 12 px.
  int window_px = 0;
  // Plain boards that are cut off or covered: take the part that is seen. Which part it is can be told from colours and
  // the picture's border alone, so that all of its corners may be numbered wrongly, by whole squares.
  bool parts = false;
};

// A corner that no picture shows: a projector's pixel that was looked up at where a camera sees the corner. Errors of
// the camera's corner move it, too: carried_corners.h.
struct LookedUp {
  struct At {
    std::size_t camera = 0;         // of the same calibration, in the same shot
    std::array<double, 4> slope{};  // d pixel / d the camera's pixel, row-major
  };
  std::vector<At> at;
  std::array<double, 3> own{};  // xx, xy, yy: covariance at given camera's pixels, px^2
};

struct Corner {
  int id = 0;
  Vec2 pixel;
  double sigma_px = 0;  // of one coordinate, as the picture's noise around this corner lets expect; 0: not known
  std::shared_ptr<const LookedUp> looked_up{};
};

struct Detection {
  std::vector<Corner> corners;        // sorted by id; empty where the board was not found
  double noise_px = 0;                // of one coordinate, estimated without any lens model; 0: no corners
  int gross_errors = 0;               // corners left out because they do not fit their neighbours
  bool part = false;                  // checkerboard: not the whole board (DetectionOptions::parts)
  int markers = 0;                    // charuco: markers that belong to the board
  int foreign_markers = 0;            // charuco: of the dictionary, but with ids that the board does not have
  bool legacy = false;                // charuco: the layout in which the corners were numbered
  std::array<int, 2> layout_votes{};  // charuco: markers that fit the current and the legacy layout
  std::string problem;                // why there are no corners
};

Detection detect_board(const io::GreyImage& image, const Board& board, const DetectionOptions& options);
// `image`: grey or RGB of any range; EXR values are linear and may exceed 1.
Detection detect_board(const io::Image& image, const Board& board, const DetectionOptions& options);

// For messages after nothing was found: the dictionary whose markers fill this picture best and how many it shows;
// empty name where there are none at all.
struct DictionaryGuess {
  std::string family;  // "5X5_1000": the largest of its family
  int markers = 0;
  int largest_id = 0;
};
DictionaryGuess guess_dictionary(const io::Image& image);

}  // namespace gonio::camera
