// Meshes as people bring them, made fit to be sliced: closed, facing outwards, every place inside once or not at all.
//
// Steps, each with its count in the report:
//   corners at one place, to the last bit, become one vertex; triangles with two corners there go
//   triangles whose corners stand in a line are taken over by a neighbour
//   copies of a triangle go, and sheets without thickness (a triangle on its own reverse)
//   rims that were torn by no more than 1e-5 of the mesh's diagonal are stitched
//   edges of more than two triangles are split, so that bodies that touch there are bodies (mesh/mend/edges.h)
//   each piece faces one way, that of most of its area
//   holes are closed (mesh/mend/holes.h): those of three edges, and those whose box has a diagonal of at most
//     `largest_hole_m`; each by less than half of what there is of its piece: a lone triangle is no body with a hole
//   pieces that enclose nothing go
//   outermost pieces are turned to face outwards; those within others become cavities where they face the other way
//     than what they lie in, or where both face inwards; a body within a body's material stays one;
//     what meets another piece lies in none: it is taken for a body
//   what overlaps is united (mesh/mend/unite.h): kept is the boundary of what is inside at all, which has a winding
//     number above 0
//
// Refused, Error(data) at `place`: no triangles, numbers that are not finite, indices that lead nowhere, holes beyond
// the limit, pieces with one side only, what encloses nothing, and more than 4 million pairs of triangles that meet.
// Coordinates of vertices that stay do not change, to the last bit; new ones are where triangles meet.
#pragma once
#include <string>
#include <vector>

#include "io/ply.h"

namespace gonio::print {

struct MendWish {
  double largest_hole_m = 0;  // 0: a twentieth of the mesh's diagonal
};

struct Mended {
  io::TriangleMesh mesh;           // positions and triangles
  std::vector<std::string> steps;  // in words; empty: nothing had to be done
  std::size_t bodies = 0, cavities = 0;
  double volume_m3 = 0;
};
Mended mend(io::TriangleMesh mesh, const MendWish& wish, const std::string& place);

}  // namespace gonio::print
