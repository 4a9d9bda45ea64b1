// Spheres cut out of a mesh (markers glued to an object), and the holes closed.
//
// Triangles within (1 + eps) radius of a centre go; the rim's loops are found and filled. The fill continues the
// curvature of the surface round it: a polynomial height over the rim's plane, of fourth degree where the band round
// the hole bears it, fitted by least squares to that band and joined to the rim. How far it can be from the truth is
// told from the band's noise and from what each further degree changed.
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
  std::size_t sphere = 0;  // whose
  std::size_t rim_vertices = 0, new_triangles = 0;
  double diameter_m = 0;     // of the rim
  std::size_t degree = 0;    // of the polynomial that continues the surface
  double depth_m = 0;        // of the fill over the rim's plane, outwards
  double uncertainty_m = 0;  // how far the fill may be from the truth, one standard deviation at its middle
};
struct Carved {
  std::vector<FilledHole> holes;
  std::size_t removed_triangles = 0;
  std::vector<std::size_t> untouched;  // spheres that the mesh does not come near
};
// Fills every loop that the carving opened; other holes stay as they are. Error(data) naming the sphere, and the mesh
// as it was, where a hole does not lie over one plane or cannot be filled without self-intersection, where carving
// would cut the mesh into parts, and where nothing of it would be left. New triangles have the label 0.
Carved carve(io::TriangleMesh& mesh, const std::vector<CarvedSphere>& spheres, double eps, const std::string& place);

}  // namespace gonio::mesh
