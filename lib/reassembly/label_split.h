// Faces split so that no crack opens: an edge is halved for both its faces, each face bisected at its longest edge.
#pragma once
#include <cstdint>
#include <functional>
#include <vector>

#include "io/ply.h"

namespace gonio::reassembly {

// Bisects the faces for which `wanted`, each once, at its longest edge (Rivara 1984), and whatever else must be
// bisected so that the mesh conforms. Normals, texture coordinates and properties of a new vertex are its edge's mean.
// `from`: for every face the face of the given mesh that it is a part of. Vertices that stand at one place (seams) are
// split together.
struct Split {
  io::TriangleMesh mesh;
  std::vector<std::uint32_t> from;
  std::vector<std::uint8_t> changed;  // per face: it is a part of what was bisected
};
Split bisect(const io::TriangleMesh& mesh, const std::vector<std::uint8_t>& wanted);

}  // namespace gonio::reassembly
