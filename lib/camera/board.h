// Calibration boards: what is printed where. Board frame: x along the columns to the right, y along the rows downwards,
// z away from the viewer; metres. Checkerboard: the origin is the first inner corner. ChArUco: the origin is the
// top-left outer corner of the squares, as in OpenCV. Corners are numbered row by row from the top left.
//
// A ChArUco board has a marker in every white square, numbered row by row. Where the rows are even in number two
// layouts exist: the current one (OpenCV >= 4.6) with a black top-left square, and the legacy one in which the top-left
// square bears a marker. With an odd number of rows they are the same.
#pragma once
#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "camera/board_terms.h"
#include "camera/marker_dictionary.h"
#include "geom/vector.h"
#include "manifest/sections/forward.h"

namespace gonio::camera {

enum class BoardKind { checkerboard, charuco };

struct Board {
  BoardKind kind = BoardKind::checkerboard;
  int corner_columns = 0, corner_rows = 0;  // inner corners
  double square_m = 0, marker_m = 0;
  std::string dictionary;      // charuco: "4X4_50"
  std::optional<bool> legacy;  // charuco with an even number of rows: unknown until it is found or given
  std::shared_ptr<const OwnDictionary> own_dictionary =
      nullptr;  // instead of the one named, whose name is then the file's

  int square_columns() const { return corner_columns + 1; }
  int square_rows() const { return corner_rows + 1; }
  int corners() const { return corner_columns * corner_rows; }
  bool layout_matters() const { return kind == BoardKind::charuco && square_rows() % 2 == 0; }
  Vec2 corner_m(int id) const;    // position of corner `id`
  BoardExtent extent() const;     // of the corners
  Vec2 squares_origin_m() const;  // top-left outer corner of the squares
  MarkerCells cells(int marker) const;
};

// Error(data) at `place` (".../boards/b") for sizes, markers and dictionaries that make no board. A board with a
// dictionary_file has its geometry only, unless that file's path is given.
Board board_of(const manifest::Board& section, const std::string& place,
               const std::filesystem::path& dictionary_file = {});
// The board of that id with its dictionary, from the manifest's file where it has one of its own.
Board board_of(const manifest::Document& document, const std::string& id);
manifest::Board section_of(const Board& board);  // without the id of a dictionary file

// "9x6", as people type it, to {9, 6}. Error(usage) at `place`.
std::vector<int> columns_and_rows(const std::string& text, const std::string& place);

struct Marker {
  int id = 0;
  std::array<Vec2, 4> corners_m;  // clockwise from the top left as seen, OpenCV's order
};
std::vector<Marker> markers(const Board& board);  // charuco; a layout that is not known counts as current

struct Rectangle {  // axis-parallel, board frame, metres
  Vec2 low_m, high_m;
};
// The black areas, as rectangles that do not overlap: squares, and cells of markers joined along rows.
std::vector<Rectangle> black_areas(const Board& board);

}  // namespace gonio::camera
