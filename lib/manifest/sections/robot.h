// "robots": arms, their nominal and their calibrated links.
#pragma once
#include <string>
#include <vector>

namespace gonio::manifest {

struct DhRow {  // standard Denavit-Hartenberg: T = Rz(theta) Tz(d) Tx(a) Rx(alpha)
  double a_m = 0, d_m = 0, alpha_rad = 0, theta_rad = 0;
};
struct Robot {              // "robots"
  std::string model;        // a known arm (robot/kinematics.h), or "dh" with `dh`
  std::vector<DhRow> dh;    // instead of the model's nominal values
  std::string calibration;  // file id of a UR controller's calibration.conf: deltas on the nominal values
};

}  // namespace gonio::manifest
