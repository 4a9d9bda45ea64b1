// Shapes that stand for what has none of its own in a drawing of the laboratory. Metres.
#pragma once
#include <vector>

#include "acquisition/plan/solid_mesh.h"
#include "io/ply.h"

namespace gonio::acquisition {

// A solid as it is drawn: its triangles; of a mesh with more than `most` of them a coarser one, its vertices gathered
// in cubes (Rossignac & Borrel 1993), as fine as that allows.
constexpr std::size_t most_drawn_triangles = 6000;
io::TriangleMesh drawn_solid(const Solid& solid, std::size_t most = most_drawn_triangles);
io::TriangleMesh ball_mesh(double radius_m);
// Edges of a pyramid from the origin to four corners and around them, as rods of three sides.
io::TriangleMesh pyramid_frame(const std::vector<Vec3>& corners, double thickness_m);
// The same pyramid, closed.
io::TriangleMesh pyramid(const std::vector<Vec3>& corners);
// Two pyramids base to base about the origin: unlike the above in outline.
io::TriangleMesh double_pyramid(double radius_m);
// A circle about z of rods, and one from the middle to x: shows how it has turned.
io::TriangleMesh dial(double radius_m, double thickness_m);

}  // namespace gonio::acquisition
