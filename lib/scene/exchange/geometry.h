// Shapes as triangles, in the object frame and metres, and as PLY files of single precision.
#pragma once
#include <string>

#include "io/ply.h"
#include "scene/scene.h"

namespace gonio::scene {

// A sphere's vertices lie on it; the seam of its texture coordinates is cut. `largest_sagitta`, a share of the radius,
// bounds the gap between the triangles and the sphere.
io::TriangleMesh triangles_of(const Shape& shape, double largest_sagitta = 1e-4);
double sagitta_of_sphere(double largest_sagitta);  // what triangles_of() reaches

// Binary little endian: float x y z [nx ny nz] [s t], then uchar 3 and three int indices.
std::string compact_ply(const io::TriangleMesh& mesh);

}  // namespace gonio::scene
