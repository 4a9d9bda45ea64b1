// A contour's vertices where spacings differ, and how the surface bends there.
//
// A place is index * scale, in voxels of the smallest spacing; there normals are normals and lengths lengths.
#pragma once
#include <cstddef>
#include <vector>

#include "geom/vector.h"
#include "volume/contour.h"

namespace gonio::volume {

struct Place {
  Vec3 index{};   // of the vertex
  Vec3 normal{};  // unit, in places
  Vec3 along{};   // change of the index for one voxel along the normal
};
inline Vec3 vector_of(const std::array<float, 3>& v) {
  return {v[0], v[1], v[2]};
}
inline Vec3 divided(Vec3 a, Vec3 b) {
  return {a.x / b.x, a.y / b.y, a.z / b.z};
}
// The stored normal is that of the gradient in indices, and d/d(index * scale) = (d/d index) / scale.
inline Vec3 normal_of(const Contour& contour, std::size_t vertex, Vec3 scale) {
  return normalized(divided(vector_of(contour.normals[vertex]), scale));
}
inline Place place_of(const Contour& contour, std::size_t vertex, Vec3 scale) {
  const Vec3 normal = normal_of(contour, vertex, scale);
  return {vector_of(contour.positions[vertex]), normal, divided(normal, scale)};
}
double area_of(const Contour& contour, Vec3 scale);  // voxels^2

// Mean curvature at the vertices, 1 / voxel, positive where the surface is convex: over the edges of the triangles
//   sum (n_b - n_a) . (p_b - p_a) / sum |p_b - p_a|^2,
// sums taken over some three voxels round, so that the noise of the normals averages out.
std::vector<float> mean_curvature(const Contour& contour, Vec3 scale);

}  // namespace gonio::volume
