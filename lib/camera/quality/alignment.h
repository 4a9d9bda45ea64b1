// Two calibrations of one camera, brought into one frame: the rigid motion between their camera frames that the boards'
// points imply (the finite form of what projection_law.h does to first order), and the difference of their predictions
// after it.
#pragma once
#include <optional>
#include <vector>

#include "camera/calibration.h"

namespace gonio::camera {

// The motion that takes `from` onto `to` with the least sum of squared distances (Kabsch 1976; Umeyama, PAMI 13(4),
// 1991).
Rigid<frame::Camera, frame::Camera> aligned(const std::vector<Vec3>& from, const std::vector<Vec3>& to);

// The pose in which a lens that is given sees a view's corners, from a pose nearby (Gauss-Newton; corners beyond
// `loss_px` pull linearly).
BoardPose pose_under(const View& view, const Board& board, const Intrinsics& lens, const BoardWarp& warp,
                     BoardPose start, double loss_px);

// The corners of one view in the camera frame, metres.
void append_points(const View& view, const Board& board, const BoardWarp& warp, const BoardPose& pose,
                   std::vector<Vec3>& points);

// Pixel of a point infinitely far in this direction, or at this place; nothing where the lens does not show it.
std::optional<Vec2> project(const Intrinsics& lens, Vec3 point_m);

}  // namespace gonio::camera
