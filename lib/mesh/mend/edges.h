// Edges of a triangle mesh with all triangles at each, however many; and surfaces made of them, in which every edge
// has two triangles at most.
#pragma once
#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "io/ply.h"
#include "mesh/adjacency.h"

namespace gonio::mesh {

struct MeshEdge {
  std::uint32_t low = 0, high = 0;     // vertices
  std::uint32_t face = 0, corner = 0;  // the triangle passes it from its corner to the next
  bool forward = false;                // from low to high
};
// Three a triangle, those of one edge together, by vertices and then by triangles.
std::vector<MeshEdge> edges_of(const std::vector<Corners>& triangles);

// body(all triangles at one edge), edge by edge.
template <class Body>
void for_each_edge(const std::vector<MeshEdge>& edges, const Body& body) {
  for (std::size_t i = 0, end = 0; i < edges.size(); i = end) {
    for (end = i; end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high;) ++end;
    body(std::span(edges).subspan(i, end - i));
  }
}

struct Surfaces {
  std::vector<std::uint32_t> piece;  // of every triangle
  std::size_t pieces = 0;
  std::size_t crowded = 0;         // edges at which more than two triangles met
  std::size_t split_vertices = 0;  // that were added, so that every edge has two triangles and every vertex one fan
  std::size_t turned = 0;          // triangles that faced the other way than most of their piece
  std::size_t one_sided = 0;       // pieces that have no two sides, as a Moebius strip
};
// Triangles are joined over edges. Where more than two meet, those that bound the same wedge of material are: going
// round the edge, from one that faces backwards to the next that faces forwards. Then each piece is made to face one
// way, that of most of its area.
Surfaces make_surfaces(io::TriangleMesh& mesh);

// Pieces over shared vertices' edges, as they are: for a mesh that make_surfaces() has seen.
std::vector<std::uint32_t> pieces_of(const io::TriangleMesh& mesh, std::size_t& count);

}  // namespace gonio::mesh
