// A mesh from the points that one camera saw, a pixel each: neighbouring pixels are joined.
#pragma once
#include <vector>

#include "geom/vector.h"
#include "io/ply.h"

namespace gonio::mesh {

// Two triangles for every four pixels that all have a point, one for three; not across steps, where an edge is longer
// than `longest` times the median of all edges. `pixels`: of each point. Points that share a pixel, lie between pixels
// or are part of no triangle are left out. Seen from the camera, whose rows run down, triangles turn anticlockwise.
io::TriangleMesh joined_neighbours(const std::vector<Vec3>& points_m, const std::vector<Vec2>& pixels,
                                   double longest = 4);

}  // namespace gonio::mesh
