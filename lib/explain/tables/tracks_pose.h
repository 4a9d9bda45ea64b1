// Scaled orthographic pose of a known shape in one frame, in closed form: the affine least squares map of its points,
// and the rotation and scale nearest to it. Frames: shape (its own), camera (x right, y down, z forward); pixels,
// metres. Horn, Hilden & Negahdaripour, JOSA A 5(7), 1988, section 3 (orthonormal matrices by singular values).
#pragma once
#include <span>
#include <vector>

#include "geom/rigid.h"
#include "geom/vector.h"

namespace gonio::explain::tables {

struct WeakPose {
  Quaternion rotation;        // camera from shape
  Vec3 centre_m;              // of the points, in the shape's frame
  double scale_px_per_m = 0;  // of the picture
  Vec2 shift_px;              // where the centre is seen
};
// Shapes that are flat are taken as seen from the front, as far as the points leave that open. Needs four points.
WeakPose weak_pose(std::span<const Vec3> points_m, std::span<const Vec2> pixels);

// What the best quadratic functions of (x, y, z) leave of u and v, scaled by sqrt(n / (n - 10)); nothing of fewer than
// 16 points.
std::vector<double> beyond_quadratic(std::span<const Vec3> points, std::span<const Vec2> pixels);

}  // namespace gonio::explain::tables
