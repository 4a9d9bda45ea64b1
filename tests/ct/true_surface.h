// The true surface of what a tomograph looked at, as a mesh.
#pragma once
#include "ct/scanner.h"
#include "io/ply.h"

namespace gonio::ct {

// The zero set of the signed distance to all parts that are no markers, in the phantom's frame: contoured on a grid
// `finer` times as fine as the scan's, then every vertex moved onto it. Normals are the distance's gradients.
io::TriangleMesh true_surface(const Phantom& phantom, const Scanner& scanner, std::size_t finer = 2);

}  // namespace gonio::ct
