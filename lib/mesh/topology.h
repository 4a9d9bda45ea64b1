// Does a mesh enclose a volume? Vertices at the same place, to the last bit, count as one: files repeat them at seams.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "mesh/mesh.h"

namespace gonio::mesh {

// For every vertex the first one, in the order of places, that stands where it does.
std::vector<std::uint32_t> welded(const std::vector<Vec3>& positions_m);

struct Topology {
  std::size_t boundary_edges = 0;       // with a triangle on one side only
  std::size_t holes = 0;                // connected pieces of boundary
  std::size_t crowded_edges = 0;        // where more than two triangles meet
  std::size_t disagreeing_edges = 0;    // whose two triangles face opposite ways
  std::size_t collapsed_triangles = 0;  // with two corners at one place; left out of all this
  double volume_m3 = 0;                 // enclosed; negative where the triangles face inwards
  // Every edge is passed as often forwards as backwards: inside and outside are defined everywhere.
  bool closed() const { return boundary_edges == 0 && disagreeing_edges == 0; }
};
Topology topology_of(const Mesh& mesh);

}  // namespace gonio::mesh
