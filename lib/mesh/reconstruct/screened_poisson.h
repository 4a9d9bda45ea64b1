// Screened Poisson reconstruction (Kazhdan & Hoppe 2013) of oriented points.
#pragma once
#include <vector>

#include "geom/vector.h"
#include "io/ply.h"

namespace gonio::mesh {

// `normals`: outwards; their lengths are confidences where `by_length` is set, 1 the usual one. Triangles are
// counter-clockwise seen from outside. Not to be called twice at the same time.
io::TriangleMesh screened_poisson(const std::vector<Vec3>& positions_m, const std::vector<Vec3>& normals, int depth,
                                  bool by_length);

}  // namespace gonio::mesh
