// Errors at poses that a fit did not see: each pose in turn is left out (every tenth of them together where there are
// more than thirty), the mountings are found from the others, and the board's place through the robot is compared with
// what the camera sees at the pose left out.
#pragma once
#include <string>
#include <vector>

#include "robot/handeye/refinement.h"

namespace gonio::robot::handeye {

struct HeldOutView {
  double rms_px = 0, translation_m = 0, rotation_rad = 0;  // of the corners; of the board's middle; of its angle
};
struct HeldOutErrors {
  std::string method;
  std::vector<HeldOutView> views;  // of the views that count, in their order
  HeldOutView rms;                 // root mean squares
};
// By the name of a closed form, "joint", or "reprojection" (reprojection.h). At least four views must count.
HeldOutErrors held_out(const Setup& setup, const std::vector<View>& views, const std::string& method);

// Error of one view under a solution.
HeldOutView error_at(const Setup& setup, const View& view, const Solution& solution);
HeldOutView root_mean_square(const std::vector<HeldOutView>& views);

}  // namespace gonio::robot::handeye
