// What passes through a cell of eight samples, for each of the 256 ways in which they can lie on the two sides of the
// threshold. Made by code from one rule; nothing is typed.
//
// One side is the separated one, S: two samples of S that face each other across a diagonal of a square are not joined
// there (that is 6-connectivity; the other side is 26-connected). Corner c of a cell lies at (c & 1, c >> 1 & 1,
// c >> 2). An edge along axis a has number 4 a + u + 2 v, where u and v are its coordinates along the axes (a + 1) % 3
// and (a + 2) % 3; face 2 a + s is the one normal to axis a at coordinate s.
//
// On each face of the cell the surface shows as straight segments between crossed edges: round the face's corners each
// run of corners of S is cut off by one segment. The segments join to simple closed loops on the cell's boundary. Each
// loop bounds one component of the corners of S (joined along edges), with one exception: where S is all but two
// opposite corners of the cell, the ring of six has two loops. The other side is joined through the cell then, and the
// surface is a tunnel between the two loops, not two disks.
//
// Where several components share a cell, a plane separates the crossings of one from those of the others, in
// coordinates x, y, z in [0, 1] counted from its own corner:
//   a lone corner: its crossings have x + y + z = t < 1; those of any other component lie on edges that start at
//   corners
//     of S with two or three coordinates 1 (those with one are its neighbours, not in S) and end at corners with at
//     least one, x + y + z > 1;
//   no lone corner: two components of at least two corners each. Three corners have only one other that is no neighbour
//   of
//     any; so there are two pairs, opposite edges of the cell, and their crossings lie on either side of x + y = 1.
// Lone corners' half-spaces do not meet within the cell: x + y + z < 1 and (1 - x) + (1 - y) + z < 1 give z < 0.
#pragma once
#include <array>
#include <cstdint>

namespace gonio::volume {

struct Sheet {
  std::uint8_t count = 0;                // of its crossings
  std::array<std::uint8_t, 12> edges{};  // in the order of the loop
  // Where other sheets share the cell: this one's region is plane . x <= bound, its crossings lie strictly within.
  std::array<std::int8_t, 3> plane{};  // zero: no plane
  std::int8_t bound = 0;
};

struct CellCase {
  std::uint8_t sheets = 0;  // each has a vertex; a tunnel has none
  bool tunnel = false;
  bool shared = false;         // several sheets, or a tunnel: the segments on its faces are drawn as they are
  bool marked = false;         // shared, or with an ambiguous face
  std::uint8_t ambiguous = 0;  // bit f: all four edges of face f are crossed
  std::array<Sheet, 4> sheet{};
  std::array<std::uint8_t, 12> sheet_of{};  // of a crossed edge
  // The next crossing round the loop of this one, and the face that the segment between them lies on. A polygon that
  // follows this order turns counter-clockwise where it is seen from the side that is not S.
  std::array<std::uint8_t, 12> next{}, next_face{};
};

// By the mask of corners in S: bit c for corner c.
const std::array<CellCase, 256>& cell_cases();

constexpr int cell_edge(int axis, int corner) {
  return 4 * axis + (corner >> ((axis + 1) % 3) & 1) + 2 * (corner >> ((axis + 2) % 3) & 1);
}
constexpr int lower_corner(int edge) {
  const int axis = edge / 4;
  return (edge & 1) << ((axis + 1) % 3) | (edge >> 1 & 1) << ((axis + 2) % 3);
}
constexpr int upper_corner(int edge) {
  return lower_corner(edge) | 1 << (edge / 4);
}

}  // namespace gonio::volume
