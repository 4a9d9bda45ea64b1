// Where the surface passes through a cell: crossings of its edges with their normals, and the vertex of a sheet.
//
// Coordinates are the cell's own, [0, 1]^3 from its lowest corner. Crossings lie where the value, linear along the
// edge, meets the threshold, at least 2^-7 from either end; with a sample beyond the volume's border the crossing lies
// half-way and its normal along the edge. Normals are minus the gradient: at the samples central differences (one-sided
// at the border), smoothed across their axis by weights 3, 10, 3 (Scharr, Optimale Operatoren in der Digitalen
// Bildverarbeitung, 2000), linear between them. Along a unit normal n of a blurred wall a central difference sees f'
// n_a + f''' n_a^3 / 6, which turns normals away from the axes by degrees where the blur is below a voxel; smoothing by
// a second moment near 1/3 makes that f' n_a + f''' n_a / 6, the same factor for each axis.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>

#include "geom/vector.h"
#include "volume/cell_cases.h"

namespace gonio::volume {

// Rows of samples round a row of cells: [z][y] counts from one before the cells' lower samples; beyond the border, the
// border's own row stands in.
struct RowsRound {
  std::array<std::array<const float*, 4>, 4> row{};
  std::array<float, 2> per_y{}, per_z{};  // of the lower and the upper sample: 1 / distance of what is subtracted
  std::uint8_t missing = 0;               // bit c: corner c lies beyond the border, on account of y or z
  std::size_t width = 0;
};

struct Neighbourhood {
  std::array<float, 8> value{};                    // by corner
  std::array<std::array<float, 8>, 3> gradient{};  // by axis and corner; of corners beyond the border, anything
  std::uint8_t missing = 0;                        // as in RowsRound, on account of x too
  double at(int corner) const { return static_cast<double>(value[static_cast<std::size_t>(corner)]); }
  Vec3 gradient_at(int corner) const;
};
// Of the cell between samples column - 1 and column of a row.
Neighbourhood neighbourhood(const RowsRound& rows, std::size_t column);

// The parameter of the crossing between two samples on different sides of the threshold, from the first to the second.
double crossing_parameter(double first, double second, double threshold);
// The same for the edge along an axis that starts at the lowest corner of a cell of a row.
double crossing_along(const RowsRound& rows, std::size_t column, int axis, double threshold);

struct Crossing {
  Vec3 point{}, normal{};
};
Crossing crossing(const Neighbourhood& near, int edge, double threshold);

struct VertexWish {
  double threshold = 0, sharpness = 0.1;
  bool hermite = true;
};
struct SheetVertex {
  Vec3 point{}, normal{};
};
// Within the cell by at least 2^-10 and, where sheets share it, on its side of the plane by 2^-9: single precision
// rounds coordinates below 8192 by at most 2^-12 each.
SheetVertex sheet_vertex(const Neighbourhood& near, const Sheet& sheet, const VertexWish& wish);

}  // namespace gonio::volume
