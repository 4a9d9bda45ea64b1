// What carving opens: triangles taken out so that a manifold border is left, and the loops of that border.
#pragma once
#include <cstdint>
#include <vector>

#include "io/ply.h"
#include "mesh/adjacency.h"
#include "mesh/carve.h"

namespace gonio::mesh {

struct Neighbours {
  explicit Neighbours(const io::TriangleMesh& mesh)
      : around(faces_of_vertices(mesh.triangles, mesh.positions_m.size())),
        behind(neighbours_of_faces(mesh.triangles, mesh.positions_m.size())) {}
  VertexFaces around;
  std::vector<Corners> behind;
};

// Marks triangles with a corner within `reach_m` of the centre, then whatever the border would hang on by a corner or
// by one edge. Returns how many are new.
std::size_t take_out(const io::TriangleMesh& mesh, const Neighbours& neighbours, Vec3 centre_m, double reach_m,
                     std::vector<bool>& out);

// Parts that hang together over edges, among triangles that are not out.
std::size_t parts_left(const Neighbours& neighbours, const std::vector<bool>& out);

// Loops of vertices along edges between a triangle that is out and one that is not, in the sense in which the triangles
// that go in pass them: with the hole on the left.
std::vector<std::vector<std::uint32_t>> opened_loops(const io::TriangleMesh& mesh, const Neighbours& neighbours,
                                                     const std::vector<bool>& out);

}  // namespace gonio::mesh
