// Meshes from which triangles were taken out.
#pragma once
#include "io/ply.h"

namespace gonio::mesh {

// Vertices that no triangle uses, and what belongs to them, go; the others keep their order.
void drop_unused(io::TriangleMesh& mesh);

}  // namespace gonio::mesh
