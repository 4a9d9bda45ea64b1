// Board corners under a rolling shutter (mechanism camera.rolling-shutter): row v of an image of h rows is read at
//   tau(v) = (v - (h - 1) / 2) / h   (readouts, from the middle row),
// and the board has then moved by tau(v) (mx, my, 0) in the camera frame, metres per readout. The row at which a corner
// is seen solves v = P_v(t + tau(v) m); the iteration contracts as long as a corner moves slower than the readout.
//
// Two numbers a view: shifts along the optical axis, and turns, look like tilts of the board to first order and are
// left to the pose. Invariant: without motion the prediction is bit-identical to that of a global shutter. Oth,
// Furgale, Kneip & Siegwart, CVPR 2013, with constant velocity inside one image.
#pragma once
#include <array>

#include "camera/board_projection.h"

namespace gonio::explain {

struct Readout {
  int height_px = 0;
  Vec2 motion_m;  // of the board in the camera frame during one readout
};
struct MovingColumn {
  static constexpr std::size_t motion = camera::BoardColumn::count;  // x, y; before them the columns of BoardColumn
  static constexpr std::size_t count = motion + 2;
};
using MovingJacobian = std::array<std::array<double, MovingColumn::count>, 2>;

// False for points behind the camera, and for motions faster than the readout.
bool predict_moving(const camera::Intrinsics& intrinsics, const camera::BoardPose& pose,
                    const camera::BoardExtent& extent, const camera::BoardWarp& warp, const Readout& readout,
                    Vec2 board_point_m, Vec2& pixel);
bool predict_moving(const camera::Intrinsics& intrinsics, const camera::BoardPose& pose,
                    const camera::BoardExtent& extent, const camera::BoardWarp& warp, const Readout& readout,
                    Vec2 board_point_m, Vec2& pixel, MovingJacobian& jacobian);

}  // namespace gonio::explain
