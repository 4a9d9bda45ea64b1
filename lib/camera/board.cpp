// Boards: the checks on what a user may state, and the geometry of squares, corners and markers.
#include "camera/board.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "base/error.h"
#include "camera/marker_dictionary.h"
#include "manifest/document.h"
#include "manifest/sections/board.h"

namespace gonio::camera {
namespace {

constexpr int largest_side = 200;  // squares or corners along one side; a sheet of film with 1 mm squares has fewer

bool marked(const Board& board, int row, int column) {  // white squares bear markers
  const bool shifted = board.layout_matters() && board.legacy.value_or(false);
  return (row + column) % 2 == (shifted ? 0 : 1);
}

std::pair<int, int> counts(const std::vector<int>& given, int least, const std::string& place, const char* what) {
  if (given.size() != 2) {
    throw Error(Exit::data, place, given.empty() ? "missing" : "not two numbers",
                std::string("give the ") + what + " as [columns, rows]");
  }
  for (const int n : given) {
    if (n < least || n > largest_side) {
      throw Error(Exit::data, place,
                  std::to_string(n) + " " + what + " along one side (limits " + std::to_string(least) + " and " +
                      std::to_string(largest_side) + ")",
                  "count columns first, then rows");
    }
  }
  return {given[0], given[1]};
}

void read_charuco(const manifest::Board& section, const std::string& place, const std::filesystem::path& file,
                  Board& board) {
  if (!section.marker_m)
    throw Error(Exit::data, place + "/marker_m", "missing", "give the side of the markers in metres");
  board.marker_m = *section.marker_m;
  if (!(board.marker_m > 0) || !(board.marker_m < board.square_m)) {
    throw Error(Exit::data, place + "/marker_m", "the marker does not fit into its square",
                "measure both sides: 0 < marker_m < square_m");
  }
  if (board.layout_matters()) board.legacy = section.legacy_layout;
  int present = 0;
  if (!file.empty()) {
    board.own_dictionary = read_dictionary(file);
    board.dictionary = board.own_dictionary->name;
    present = static_cast<int>(board.own_dictionary->white.size());
  } else if (!section.dictionary_file.empty()) {
    return;
  } else if (section.dictionary.empty()) {
    throw Error(Exit::data, place + "/dictionary", "missing", "name the markers' dictionary, such as 4X4_50");
  } else {
    board.dictionary = dictionary_name(section.dictionary, place + "/dictionary");
    present = dictionary_size(board.dictionary);
  }
  const int needed = board.square_columns() * board.square_rows() / 2;
  if (needed > present) {
    throw Error(
        Exit::data, place + "/dictionary",
        board.dictionary + " has " + std::to_string(present) + " markers, the board needs " + std::to_string(needed),
        board.own_dictionary ? "add markers to the file" : "take the larger dictionary of the family");
  }
}

}  // namespace

Vec2 Board::squares_origin_m() const {
  return kind == BoardKind::charuco ? Vec2{0, 0} : Vec2{-square_m, -square_m};
}

Vec2 Board::corner_m(int id) const {
  const Vec2 origin = squares_origin_m();
  return {origin.x + (id % corner_columns + 1) * square_m, origin.y + (id / corner_columns + 1) * square_m};
}

BoardExtent Board::extent() const {
  const Vec2 first = corner_m(0), last = corner_m(corners() - 1);
  return {(first + last) * 0.5, (last - first) * 0.5};
}

MarkerCells Board::cells(int marker) const {
  return own_dictionary ? marker_cells(*own_dictionary, marker) : marker_cells(dictionary, marker);
}

std::vector<int> columns_and_rows(const std::string& text, const std::string& place) {
  int columns = 0, rows = 0;
  const char *begin = text.data(), *end = begin + text.size();
  const auto first = std::from_chars(begin, end, columns);
  if (first.ec == std::errc{} && first.ptr != end && (*first.ptr == 'x' || *first.ptr == 'X')) {
    const auto second = std::from_chars(first.ptr + 1, end, rows);
    if (second.ec == std::errc{} && second.ptr == end) return {columns, rows};
  }
  throw Error(Exit::usage, place, "\"" + text + "\" is not columns x rows", "write for example 9x6");
}

Board board_of(const manifest::Board& section, const std::string& place, const std::filesystem::path& dictionary_file) {
  Board board;
  if (!(section.square_m > 0) || !std::isfinite(section.square_m)) {
    throw Error(Exit::data, place + "/square_m", "the side of a square is not above 0", "give it in metres");
  }
  board.square_m = section.square_m;
  if (section.kind == "checkerboard") {
    std::tie(board.corner_columns, board.corner_rows) =
        counts(section.inner_corners, 2, place + "/inner_corners", "inner corners");
    if (std::max(board.corner_columns, board.corner_rows) < 3) {
      throw Error(Exit::data, place + "/inner_corners", "2 x 2 corners are too few to be told from the background",
                  "use a board with at least 3 x 2 inner corners");
    }
  } else if (section.kind == "charuco") {
    board.kind = BoardKind::charuco;
    const auto [columns, rows] = counts(section.squares, 3, place + "/squares", "squares");
    board.corner_columns = columns - 1;
    board.corner_rows = rows - 1;
    read_charuco(section, place, dictionary_file, board);
  } else {
    throw Error(Exit::data, place + "/kind", "\"" + section.kind + "\" is no kind of board",
                "use checkerboard or charuco");
  }
  return board;
}

Board board_of(const manifest::Document& document, const std::string& id) {
  const std::string pointer = "/boards/" + id, place = manifest::place(document, pointer);
  const auto found = document.boards.find(id);
  if (found == document.boards.end()) throw Error(Exit::data, place, "missing", "describe the board");
  const manifest::Board& section = found->second;
  if (section.dictionary_file.empty()) return board_of(section, place);
  if (!section.dictionary.empty()) {
    throw Error(Exit::data, place + "/dictionary_file", "stands beside \"dictionary\"", "give one of the two");
  }
  return board_of(section, place, manifest::resolve(document, section.dictionary_file, pointer + "/dictionary_file"));
}

manifest::Board section_of(const Board& board) {
  manifest::Board section;
  section.square_m = board.square_m;
  if (board.kind == BoardKind::checkerboard) {
    section.kind = "checkerboard";
    section.inner_corners = {board.corner_columns, board.corner_rows};
  } else {
    section.kind = "charuco";
    section.squares = {board.square_columns(), board.square_rows()};
    section.marker_m = board.marker_m;
    if (!board.own_dictionary) section.dictionary = board.dictionary;
    if (board.layout_matters()) section.legacy_layout = board.legacy;
  }
  return section;
}

std::vector<Marker> markers(const Board& board) {
  std::vector<Marker> list;
  const double margin = 0.5 * (board.square_m - board.marker_m);
  for (int row = 0; row < board.square_rows(); ++row) {
    for (int column = 0; column < board.square_columns(); ++column) {
      if (!marked(board, row, column)) continue;
      const double left = column * board.square_m + margin, top = row * board.square_m + margin;
      const double right = left + board.marker_m, bottom = top + board.marker_m;
      list.push_back({static_cast<int>(list.size()), {Vec2{left, top}, {right, top}, {right, bottom}, {left, bottom}}});
    }
  }
  return list;
}

std::vector<Rectangle> black_areas(const Board& board) {
  std::vector<Rectangle> areas;
  const Vec2 origin = board.squares_origin_m();
  for (int row = 0; row < board.square_rows(); ++row) {
    for (int column = 0; column < board.square_columns(); ++column) {
      const bool black = board.kind == BoardKind::checkerboard ? (row + column) % 2 == 0 : !marked(board, row, column);
      if (!black) continue;
      const Vec2 low{origin.x + column * board.square_m, origin.y + row * board.square_m};
      areas.push_back({low, low + Vec2{board.square_m, board.square_m}});
    }
  }
  if (board.kind == BoardKind::checkerboard) return areas;
  for (const Marker& marker : markers(board)) {
    const MarkerCells cells = board.cells(marker.id);
    const Vec2 top_left = marker.corners_m[0];
    const double cell = board.marker_m / cells.side;
    for (int y = 0; y < cells.side; ++y) {
      for (int x = 0; x < cells.side; ++x) {
        const int first = x;
        while (x < cells.side && cells.black[static_cast<std::size_t>(y * cells.side + x)]) ++x;
        if (x == first) continue;
        areas.push_back({top_left + Vec2{first * cell, y * cell}, top_left + Vec2{x * cell, (y + 1) * cell}});
      }
    }
  }
  return areas;
}

}  // namespace gonio::camera
