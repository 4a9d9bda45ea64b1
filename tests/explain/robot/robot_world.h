// A robot cell that shares no code with lib/: an arm of UR5e's dimensions by products of exponentials about axes read
// off its drawing, a pinhole camera, a board on the table. What it makes is a sealed case: the manifest that a user
// would hand on, where the robot is believed to be nominal.
#pragma once
#include <array>
#include <cstdint>

#include "manifest/sections/forward.h"

namespace gonio::explain::tests {

struct CellTruth {
  std::array<double, 6> joint_offset_rad{};
  double sag_rad_per_m = 0;  // of joints 2 and 3 alike
  double longer_upper_arm_m = 0;
  double robot_shift_m = 5e-5, robot_turn_rad = 5e-5;  // noise of every pose, one coordinate, one axis
  double corner_px = 0.1;
  double tilt_rad = 0.7;                      // the camera looks at the board up to this much aslant
  double board_stretch = 0, board_sag_m = 0;  // both axes; a paraboloid over x
  std::array<double, 6> backlash_rad{};       // play of the joints: half of it to either side
  double growth_per_K = 0;                    // of all lengths of the arm
  double warming_K = 0;                       // from the first image to the last; stated in the manifest
  bool in_motion = false;                     // one smooth drive, an image every 0.1 s, times stated
  double lag_s = 0;                           // images are of poses that are stated this much later
};

// `views` images of an 8 x 6 board of 30 mm squares by a camera in the hand, "mountings" a few millimetres off.
manifest::Document robot_cell(const CellTruth& truth, std::size_t views, std::uint64_t seed);

}  // namespace gonio::explain::tests
