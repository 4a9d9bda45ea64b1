// The triangles of a broken mesh, one by one: corners at one place become one vertex, triangles that are none go.
#pragma once
#include <cstddef>

#include "io/ply.h"

namespace gonio::mesh {

struct CleanedFaces {
  std::size_t merged_vertices = 0;  // at the place of another, to the last bit
  std::size_t collapsed = 0;        // triangles with two corners at one place
  std::size_t needles = 0;          // whose corners stand in a line: their neighbour took the middle one over
  std::size_t doubled = 0;          // copies of a triangle that stays
  std::size_t cancelled = 0;        // that lie on their own reverse where nothing needs them: sheets without thickness
};
// Positions and triangles alone are kept.
CleanedFaces clean_faces(io::TriangleMesh& mesh);

// Corners at one place become one vertex, and triangles with two corners there go; how many did.
struct Merged {
  std::size_t vertices = 0, collapsed = 0;
};
Merged merge_places(io::TriangleMesh& mesh);

// The needles alone.
std::size_t turn_needles(io::TriangleMesh& mesh);

// Vertices at the rims of holes that lie within `reach_m` of each other, and not along one edge, become one: a rim that
// was torn. Returns how many went.
std::size_t stitch_rims(io::TriangleMesh& mesh, double reach_m);

double signed_volume_m3(const io::TriangleMesh& mesh);

}  // namespace gonio::mesh
