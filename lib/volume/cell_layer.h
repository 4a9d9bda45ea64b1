// The cells between two slices of samples that the surface passes through.
//
// Cells count from the ring of samples beyond the border: cell (column, row, layer) lies between samples column - 1 and
// column along a row of the volume, and so on; width + 1 cells a row.
#pragma once
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "volume/cell_cases.h"
#include "volume/sample_window.h"

namespace gonio::volume {

struct Cell {
  std::uint32_t first_vertex = 0;    // of its sheets
  std::uint32_t first_crossing = 0;  // vertices at crossings of its own edges: the three at its lowest corner
  std::uint16_t column = 0;
  std::uint8_t mask = 0;       // corners of the separated side: cell_cases.h
  std::uint8_t crossings = 0;  // bit a: the crossing of the edge along axis a has a vertex
  const CellCase& kind() const { return cell_cases()[mask]; }
  std::uint32_t crossing_vertex(int axis) const {
    return first_crossing + static_cast<std::uint32_t>(std::popcount(crossings & ((1u << axis) - 1)));
  }
};

struct CellLayer {
  std::vector<Cell> cells;               // by row, then column
  std::vector<std::uint32_t> row_first;  // rows + 1 positions in `cells`
  std::vector<std::uint32_t> place;      // of a cell, by row and column; of cells that are not there, anything
  std::size_t columns = 0;
  std::size_t rows() const { return row_first.size() - 1; }
  // Only cells that the surface passes through.
  const Cell& at(std::size_t column, std::size_t row) const { return cells[place[row * columns + column]]; }
};

// The cells between slices `layer` and `layer` + 1 of the window, counted from the ring. `flip` is 0 where S, the
// separated side, is inside, else 255.
void find_cells(const SampleWindow& window, std::size_t layer, std::uint8_t flip, CellLayer& found);

inline constexpr std::size_t rows_at_once = 16;  // of one chunk of a parallel loop

}  // namespace gonio::volume
