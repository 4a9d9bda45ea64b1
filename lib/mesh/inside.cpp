// Winding number: the solid angle that the triangles fill over 4 pi (van Oosterom & Strackee 1983; Jacobson, Kavan &
// Sorkine-Hornung 2013),
//   tan(omega / 2) = a.(b x c) / (|a||b||c| + a.b |c| + b.c |a| + c.a |b|)
// Distance to a triangle: to its plane where the foot lies inside, else to the nearest edge.
#include "mesh/inside.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gonio::mesh {
namespace {

double squared_to_segment(Vec3 p, Vec3 a, Vec3 b) {
  const Vec3 along = b - a, arm = p - a;
  const double length = dot(along, along);
  const double t = length > 0 ? std::clamp(dot(arm, along) / length, 0.0, 1.0) : 0;
  const Vec3 gap = arm - along * t;
  return dot(gap, gap);
}

double squared_to_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 n = cross(b - a, c - a);
  const bool above = dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 &&
                     dot(cross(a - c, p - c), n) >= 0 && dot(n, n) > 0;
  if (above) return dot(p - a, n) * dot(p - a, n) / dot(n, n);
  return std::min({squared_to_segment(p, a, b), squared_to_segment(p, b, c), squared_to_segment(p, c, a)});
}

}  // namespace

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
  double squared = std::numeric_limits<double>::infinity();
  for (const auto& t : mesh.triangles)
    squared = std::min(
        squared, squared_to_triangle(point_m, mesh.positions_m[t[0]], mesh.positions_m[t[1]], mesh.positions_m[t[2]]));
  return std::sqrt(squared);
}

}  // namespace gonio::mesh
