// How much robot and camera scatter.
#pragma once

namespace gonio::robot::handeye {

struct Noise {
  double corner = 1;                  // factor on sigma_px
  double robot_m = 0, robot_rad = 0;  // one coordinate, one axis
  double board_rad = 0;               // one axis
};

}  // namespace gonio::robot::handeye
