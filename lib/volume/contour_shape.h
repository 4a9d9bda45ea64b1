// A contour's vertices where spacings differ, and how the surface bends there.
//
// A place is index * scale, in voxels of the smallest spacing; there normals are normals and lengths lengths.
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
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

// The surface round a vertex in places: heights over its tangent plane are -(kuu u^2 + 2 kuv u v + kvv v^2) / 2, u and
// v along t and b of Basis(normal); curvatures in 1 / voxel, positive where the surface is convex.
struct LocalShape {
  Vec3 normal{};
  double kuu = 0, kuv = 0, kvv = 0;
  double mean_curvature() const { return (kuu + kvv) / 2; }
  double sharpest() const {  // the larger of the two principal ones, without its sign
    return std::abs(kuu + kvv) / 2 + std::hypot((kuu - kvv) / 2, kuv);
  }
};

// From the normals of the vertices round, up to three edges away and turned by less than 37 degrees:
//   n_j - n = S (p_j - p), n and S by least squares,
// so that the noise of single normals averages out without flattening what is round. Curvatures are held to what
// voxels can show.
class ContourShapes {
 public:
  ContourShapes(const Contour& contour, Vec3 scale);
  LocalShape at(std::size_t vertex) const;

 private:
  const Contour& contour_;
  Vec3 scale_;
  std::vector<std::uint32_t> first_{}, neighbours_{};  // of vertex v: neighbours_[first_[v]] ... before first_[v + 1]
};

}  // namespace gonio::volume
