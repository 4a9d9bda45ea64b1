// Bodies that are given by a function of space, made a mesh.
#pragma once
#include <functional>

#include "geom/vector.h"
#include "io/ply.h"

namespace gonio::glass {

// Inside where `field` > 0, about the (negative) distance near its surface. Sampled on a grid of `cells` over the cube
// from -half to half, contoured (volume/contour.h: closed, manifold, without self-intersections), and, where it has
// more than `faces`, decimated. `smooth`: normals of the field at the vertices; else every triangle has its own.
// The largest component is kept. Error(data) where there is nothing inside, or the body leaves the cube.
io::TriangleMesh body_of(const std::function<double(Vec3)>& field, double half, int cells, std::size_t faces,
                         bool smooth);

// Distances, negative inside; Quilez's list of them is the usual source.
double distance_to_box(Vec3 p, Vec3 half, double rounding);
double distance_to_capsule(Vec3 p, Vec3 a, Vec3 b, double radius);
double distance_to_torus(Vec3 p, Vec3 axis, double ring, double tube);  // about the origin
double distance_to_cylinder(Vec3 p, Vec3 axis, double radius, double half);
// The union with a fillet of about `width` (polynomial smooth minimum).
double blended(double a, double b, double width);

}  // namespace gonio::glass
