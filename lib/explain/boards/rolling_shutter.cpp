// See rolling_shutter.h. With P the projection at the pose of the corner's own row and P,t its derivative by the shift,
// the row's equation differentiates to
//   dv (1 - P_v,t . m / h) = dP_v + tau P_v,t . dm,   du = dP_u + tau P_u,t . dm + (P_u,t . m / h) dv.
#include "explain/boards/rolling_shutter.h"

#include <algorithm>
#include <cmath>

namespace gonio::explain {
namespace {

using camera::BoardColumn;
constexpr int most_iterations = 50;
constexpr double settled_px = 1e-10;

double readouts(double row, int height_px) {
  return (row - 0.5 * (height_px - 1)) / height_px;
}

camera::BoardPose shifted(camera::BoardPose pose, double tau, Vec2 motion) {
  pose.translation_m = pose.translation_m + Vec3{tau * motion.x, tau * motion.y, 0};
  return pose;
}

}  // namespace

bool predict_moving(const camera::Intrinsics& intrinsics, const camera::BoardPose& pose,
                    const camera::BoardExtent& extent, const camera::BoardWarp& warp, const Readout& readout, Vec2 at,
                    Vec2& pixel) {
  if (!camera::predict(intrinsics, pose, extent, warp, at, pixel)) return false;
  if (readout.motion_m.x == 0 && readout.motion_m.y == 0) return true;
  for (int i = 0; i < most_iterations; ++i) {
    const double row = pixel.y;
    const camera::BoardPose then = shifted(pose, readouts(row, readout.height_px), readout.motion_m);
    if (!camera::predict(intrinsics, then, extent, warp, at, pixel)) return false;
    if (std::abs(pixel.y - row) < settled_px) return true;
  }
  return false;
}

bool predict_moving(const camera::Intrinsics& intrinsics, const camera::BoardPose& pose,
                    const camera::BoardExtent& extent, const camera::BoardWarp& warp, const Readout& readout, Vec2 at,
                    Vec2& pixel, MovingJacobian& jacobian) {
  jacobian = {};
  if (!predict_moving(intrinsics, pose, extent, warp, readout, at, pixel)) return false;
  const double tau = readouts(pixel.y, readout.height_px);
  std::array<std::array<double, BoardColumn::count>, 2> still{};
  if (!camera::predict(intrinsics, shifted(pose, tau, readout.motion_m), extent, warp, at, pixel, still)) return false;
  std::array<double, 2> drift{};  // what one row later does to (u, v)
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::copy(still[axis].begin(), still[axis].end(), jacobian[axis].begin());
    const double along_x = still[axis][BoardColumn::translation], along_y = still[axis][BoardColumn::translation + 1];
    jacobian[axis][MovingColumn::motion] = tau * along_x;
    jacobian[axis][MovingColumn::motion + 1] = tau * along_y;
    drift[axis] = (along_x * readout.motion_m.x + along_y * readout.motion_m.y) / readout.height_px;
  }
  if (drift[0] == 0 && drift[1] == 0) return true;
  for (std::size_t c = 0; c < MovingColumn::count; ++c) {
    jacobian[1][c] /= 1 - drift[1];
    jacobian[0][c] += drift[0] * jacobian[1][c];
  }
  return true;
}

}  // namespace gonio::explain
