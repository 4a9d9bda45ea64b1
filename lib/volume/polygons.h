// The polygons between the cells of neighbouring layers: why they do not intersect, and which are drawn how, stands in
// contour.h.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "volume/cell_layer.h"
#include "volume/sheet_vertex.h"

namespace gonio::volume {

using Position = std::array<float, 3>;
using Triangle = std::array<std::uint32_t, 3>;

// What a stretch of rows gives: the vertices at crossings that became necessary, and triangles.
struct Drawn {
  std::vector<Position> positions, normals;
  std::vector<Triangle> triangles;  // between vertices that have their numbers
  std::vector<Triangle> fans;       // the first corner counts from `positions`
  std::size_t crossed_edges = 0, split_polygons = 0;
  void clear();
};

// Rows of samples round a row of cells.
RowsRound rows_round(const SampleWindow& window, const std::array<std::size_t, 3>& size, std::size_t row,
                     std::size_t layer);

struct Layers {
  std::array<CellLayer*, 3> layer{};  // two below, below, here
  std::size_t here = 0;               // the number of the last
  std::span<const Position> positions{};
  bool separate_inside = false;  // S is inside
  double threshold = 0;
};

// Polygons round the crossed edges that start at the lowest corners of the cells of a row of the layer `here`. Notes in
// those cells which crossings got a vertex, counted from `drawn`.
void draw_polygons(const Layers& layers, std::size_t row, const RowsRound& samples, Drawn& drawn);

// The triangles over segments on faces, for a row of the layer below `here`; crossings have their numbers by now.
void draw_faces(const Layers& layers, std::size_t row, Drawn& drawn);

}  // namespace gonio::volume
