// From a point of a calibration board to its pixel, as templates over the scalar, for whoever differentiates by dual
// numbers. board_projection.h has the same with derivatives in closed form, which calibration and explain share.
//
// Board frame: x along the columns to the right, y along the rows downwards, z = x cross y, away from the viewer;
// metres. A board that is not flat (mechanism board.warp) has
//   z = sag_x (1 - xi^2) + sag_y (1 - eta^2),   xi, eta in [-1, 1] over the rectangle of its inner corners,
// the two-parameter paraboloid of mrcal (Kogan, "mrcal: camera calibration", 2021): zero at the outermost corners, so
// that sag is not mistaken for a shift. Invariant: without sag z is exactly zero, and the prediction bit-identical to
// that of a flat board.
#pragma once
#include "camera/lens_terms.h"
#include "geom/vector.h"

namespace gonio::camera {

struct BoardExtent {  // of the inner corners: middle and half widths, in the board's frame
  Vec2 middle_m, half_m{1, 1};
};

// Height of the board at `at`; sag: [sag_x_m, sag_y_m].
template <class T>
T board_height(const BoardExtent& extent, Vec2 at, const T* sag) {
  const double xi = (at.x - extent.middle_m.x) / extent.half_m.x, eta = (at.y - extent.middle_m.y) / extent.half_m.y;
  return sag[0] * (1 - xi * xi) + sag[1] * (1 - eta * eta);
}

// Pixel of a point in the camera frame. intrinsics: [fx fy cx cy]; distortion: as distortion_names. False where the
// lens shows no such point, behind a perspective camera.
template <class T>
bool project_point(const T* point_m, const T* intrinsics, const T* distortion, T* pixel) {
  T x, y, xd, yd;
  if (!lay_on_plane(distortion[LensTerm::fisheye], point_m, &x, &y)) return false;
  distort(distortion, x, y, &xd, &yd);
  pixel[0] = intrinsics[0] * xd + intrinsics[2];
  pixel[1] = intrinsics[1] * yd + intrinsics[3];
  return true;
}

}  // namespace gonio::camera
