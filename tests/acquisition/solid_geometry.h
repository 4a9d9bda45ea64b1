// Solids by formulas of their own, which share nothing with FCL: signed distances, nearest points, points on surfaces.
#pragma once
#include <vector>

#include "acquisition/laboratory/solid.h"

namespace gonio::tests {

// From a point to a box, ball or cylinder, both in the solid's coordinates; negative inside.
double signed_distance(const acquisition::Solid& solid, Vec3 point);
// The point of the (filled) solid nearest to `point`.
Vec3 nearest_in(const acquisition::Solid& solid, Vec3 point);
// Largest n . p over the solid.
double support(const acquisition::Solid& solid, Vec3 n);
// Points all over the surface, none farther than about `spacing_m` from the next; of a mesh on its triangles.
std::vector<Vec3> surface_points(const acquisition::Solid& solid, double spacing_m);

}  // namespace gonio::tests
