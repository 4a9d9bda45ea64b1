// Where a camera is asked to stand before a board, and how that is said.
#pragma once
#include <string>

#include "camera/board_projection.h"

namespace gonio::robot::handeye {

struct Viewpoint {
  double tilt_deg = 0;     // of the board against the camera, about its middle
  double azimuth_deg = 0;  // from where: 0 its right, 90 below, 180 its left, 270 above
  double spin_deg = 0;     // of the camera about its axis
  double distance_m = 0;   // to the board's middle
};

// camera_from_board of a camera that looks at the board's middle, in the board's frame.
camera::BoardPose pose_of(const Viewpoint& v, Vec3 middle_m);
// "view the board from its right, tilted by 30 degrees, at 0.50 m, turn the camera by 90 degrees about the optical
// axis". `mover`: "turn the camera", or "turn the board" where the arm holds that.
std::string in_words(const Viewpoint& v, const std::string& mover = "turn the camera");

}  // namespace gonio::robot::handeye
