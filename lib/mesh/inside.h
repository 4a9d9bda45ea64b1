// Where a point stands against a mesh. Both look at every triangle.
#pragma once
#include "mesh/mesh.h"

namespace gonio::mesh {

// How often the mesh goes around the point: 1 inside of a closed mesh that faces outwards, 0 outside, -1 inside of one
// that faces inwards; in between near the holes of an open one.
double winding_number(const Mesh& mesh, Vec3 point_m);
double distance_m(const Mesh& mesh, Vec3 point_m);  // to the nearest triangle

}  // namespace gonio::mesh
