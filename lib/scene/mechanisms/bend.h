// What is bent a little: heights that grow with the square of the distance, as a plate's do that curls.
//   z' = z + (curl_x x^2 + 2 twist x y + curl_y y^2) / 2,
// x and y from the middle, metres; curl_x, curl_y and twist are curvatures, 1/m (Timoshenko & Woinowsky-Krieger 1959,
// section 9). geometry.bend: of a mesh about the middle of its box, along the mesh's own axes. ground.not-flat: of a
// plane about its own middle.
#pragma once
#include <span>

#include "geom/vector.h"

namespace gonio::equation {

// p: curl_x_per_m, curl_y_per_m, twist_per_m.
inline double bend_height_m(double x_m, double y_m, std::span<const double> p) {
  return 0.5 * (p[0] * x_m * x_m + 2 * p[2] * x_m * y_m + p[1] * y_m * y_m);
}
inline Vec3 bent(Vec3 at_m, Vec3 middle_m, std::span<const double> p) {
  return at_m + Vec3{0, 0, bend_height_m(at_m.x - middle_m.x, at_m.y - middle_m.y, p)};
}

}  // namespace gonio::equation
