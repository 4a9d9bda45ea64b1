// A polygon in the plane, filled with triangles whose corners are its own and points spread evenly inside.
#pragma once
#include <array>
#include <cstdint>
#include <vector>

#include "geom/vector.h"

namespace gonio::mesh {

struct FlatTriangulation {
  std::vector<Vec2> inner;                              // new points, numbered behind the polygon's
  std::vector<std::array<std::uint32_t, 3>> triangles;  // counter-clockwise
};
// Constrained Delaunay; empty where the polygon crosses itself or has no area. Counter-clockwise polygons only.
FlatTriangulation flat_triangulation(const std::vector<Vec2>& polygon, double spacing);

}  // namespace gonio::mesh
