// Images of a board at poses of a robot, with the corners found in them, and the camera that took them.
#pragma once
#include <string>
#include <vector>

#include "camera/board_projection.h"
#include "robot/handeye/samples.h"

namespace gonio::robot::handeye {

struct SeenCorner {
  Vec2 board_m, pixel;
  double sigma_px = 0;  // of one coordinate, as the detector estimated it
};
struct View {
  std::string image;
  Rigid<frame::Base, frame::Tool> base_from_tool;  // as the controller said
  camera::BoardPose camera_from_board;             // a start, from the camera alone
  std::vector<SeenCorner> corners;
};
struct Setup {
  Kind kind = Kind::eye_in_hand;
  camera::Intrinsics lens;  // held; their covariance widens the result's
  std::vector<std::string> lens_order;
  std::vector<double> lens_covariance;  // of lens_order, row-major; empty: taken as exact
  camera::BoardExtent extent;
  camera::BoardWarp warp;
  int width_px = 0, height_px = 0;
  Vec3 middle_m() const { return {extent.middle_m.x, extent.middle_m.y, 0}; }
};

// The board's pose by the camera alone: least squares of the corners under Huber's loss, from view.camera_from_board.
camera::BoardPose pose_by_camera(const Setup& setup, const View& view);
std::vector<PoseSample> samples_of(const Setup& setup, const std::vector<View>& views);

// The board's pose in a view as the robot and a solution predict it.
camera::BoardPose predicted_pose(Kind kind, const View& view, const Solution& solution);
// Root mean square distance between found corners and those of a board at `pose`; infinite where one is behind the
// camera.
double rms_px(const Setup& setup, const View& view, const camera::BoardPose& pose);

}  // namespace gonio::robot::handeye
