// A flat sample whose cells form a binary pattern: rows x columns of equal rectangles, bit 1 or 0 each.
//
// Pattern frame, metres: origin at the outer corner top left, x along the columns to the right, y along the rows
// downwards, z into the sample, away from who looks at it. Corners are numbered clockwise as seen, of the sample and
// not of the picture: 0 top left, 1 top right, 2 bottom right, 3 bottom left; they turn with the sample. A data matrix
// stands upright in it: its solid lines are the left column and the bottom row, and its solid modules have bit 1.
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "geom/vector.h"

namespace gonio::contrast {

struct CellPattern {
  int rows = 0, columns = 0;
  Vec2 cell_m;
  std::vector<std::uint8_t> bits;  // row by row from the top; empty: not known
  std::size_t cells() const { return static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns); }
  bool known() const { return !bits.empty(); }
  Vec2 size_m() const { return {columns * cell_m.x, rows * cell_m.y}; }
  Vec2 corner_m(int k) const;             // 0 .. 3
  Vec2 middle_m(std::size_t cell) const;  // of a cell
  // The middle of a cell in units of the pattern's half size: [-1, 1] both ways.
  Vec2 place(std::size_t cell) const;
};

struct Bits {
  int rows = 0, columns = 0;
  std::vector<std::uint8_t> bits;
};
// A picture of one pixel a cell (above one half: 1), or text of one character a cell: 1 # X are 1, 0 . _ are 0, blanks,
// commas and semicolons between them do not count; empty lines and lines that begin with % are passed over.
// Error(data) at the line for other characters and for rows of another length.
Bits read_bits(const std::filesystem::path& path);
Bits parse_bits(const std::string& text, const std::string& name);

// Every cell half a turn or a quarter turn further: what stands where, once the sample is turned clockwise as seen.
Bits turned(const Bits& bits, int quarter_turns);

}  // namespace gonio::contrast
