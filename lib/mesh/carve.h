// Spheres cut out of a mesh (markers glued to an object), and the holes closed.
//
// Triangles within (1 + eps) radius of a centre go; the rim's loops are found and filled. The fill continues the
// curvature of the surface round it: vertices of a refined fill are placed by minimising the variation of curvature
// (tri-Laplacian, Botsch & Kobbelt 2004) over the patch with two rings of the surface as its border; it lies on the
// outer side where the object is convex. How far it can be from the truth is told from the hole's size and the
// disagreement between the continuation of first, second and third order.
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "io/ply.h"

namespace gonio::mesh {

struct CarvedSphere {
  Vec3 centre_m{};
  double radius_m = 0;
};
struct FilledHole {
  std::size_t sphere = 0;            // whose
  std::size_t rim_vertices = 0, new_triangles = 0;
  double diameter_m = 0;             // of the rim
  double depth_m = 0;                // of the fill over the rim's plane, outwards
  double uncertainty_m = 0;          // how far the fill may be from the truth, one standard deviation at its middle
};
struct Carved {
  std::vector<FilledHole> holes;
  std::size_t removed_triangles = 0;
  std::vector<std::size_t> untouched;  // spheres that the mesh does not come near
};
// Fills every loop that the carving opened; other holes stay as they are. Error(data) naming the sphere where a loop
// cannot be filled without self-intersection, or where carving would cut the mesh into parts (both parts stay: said).
Carved carve(io::TriangleMesh& mesh, const std::vector<CarvedSphere>& spheres, double eps, const std::string& place);

}  // namespace gonio::mesh
