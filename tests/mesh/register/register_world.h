// Views of things whose overlaps hold a motion, or do not, by tests/mesh/seen_world.h.
#pragma once
#include "geom/covariance.h"
#include "mesh/register.h"
#include "mesh/seen_world.h"
#include "mesh/shapes.h"

namespace gonio::tests {

// Bumps and hollows over 14 cm: what holds a motion in every direction.
inline io::TriangleMesh free_form() {
  return mesh::shapes::grid(120, 120, false, [](double u, double v) {
    const double x = 0.14 * (v - 0.5), y = 0.14 * (0.5 - u);
    return Vec3{x, y, 0.012 * std::sin(60 * x + 0.4) * std::cos(45 * y) + 0.008 * std::sin(80 * y + 30 * x)};
  });
}
inline io::TriangleMesh flat() {
  return mesh::shapes::grid(2, 2, false, [](double u, double v) {
    return Vec3{0.14 * (v - 0.5), 0.14 * (0.5 - u), 0};
  });
}
// About the y axis, towards +z; `lean`: how its radius grows along y.
inline io::TriangleMesh round_about_y(double radius_m, double lean) {
  return mesh::shapes::grid(40, 400, true, [=](double u, double v) {
    const double y = 0.14 * (0.5 - u), r = radius_m + lean * y;
    return Vec3{r * std::sin(2 * pi * v), y, r * std::cos(2 * pi * v)};
  });
}

struct SeenViews {
  std::vector<Vec3> cameras{{-0.12, 0.03, 0.4}, {0.12, -0.02, 0.4}};
  int side = 70;
  double f_px = 210;
};

inline mesh::MeasuredPoints seen(const io::TriangleMesh& thing, const SeenViews& views, std::uint64_t seed) {
  const mesh::TriangleTree tree(thing.positions_m, thing.triangles);
  mesh::MeasuredPoints points;
  for (const Vec3 camera : views.cameras)
    see(tree, thing, {.camera = camera, .target = {}, .width = views.side, .height = views.side, .f_px = views.f_px},
        seed, points);
  return points;
}

// What an arm that errs by the motion would say of the view.
inline void misplace(mesh::MeasuredPoints& points, std::uint32_t view, const mesh::ViewMotion& error) {
  const Mat3 r = matrix_of(error.rotation);
  for (std::size_t i = 0; i < points.view.size(); ++i) {
    if (points.view[i] != view) continue;
    points.positions_m[i] = error * points.positions_m[i];
    points.covariance_m2[i] = turned_covariance(r, points.covariance_m2[i]);
  }
  for (Vec3& from : points.viewpoints_m[view]) from = error * from;
}

}  // namespace gonio::tests
