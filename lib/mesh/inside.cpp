// Winding number: the solid angle that the triangles fill over 4 pi (van Oosterom & Strackee 1983; Jacobson, Kavan &
// Sorkine-Hornung 2013),
//   tan(omega / 2) = a.(b x c) / (|a||b||c| + a.b |c| + b.c |a| + c.a |b|)
#include "mesh/inside.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "mesh/triangle_tree.h"

namespace gonio::mesh {

double winding_number(const Mesh& mesh, Vec3 point_m) {
  double half_angles = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.positions_m[t[0]] - point_m, b = mesh.positions_m[t[1]] - point_m,
               c = mesh.positions_m[t[2]] - point_m;
    const double la = norm(a), lb = norm(b), lc = norm(c);
    half_angles += std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return half_angles / (2 * pi);
}

double distance_m(const Mesh& mesh, Vec3 point_m) {
  double least = std::numeric_limits<double>::infinity();
  for (const auto& [a, b, c] : mesh.triangles) {
    const auto& p = mesh.positions_m;
    least = std::min(least, norm(point_m - closest_on_triangle(point_m, p[a], p[b], p[c]).point));
  }
  return least;
}

}  // namespace gonio::mesh
