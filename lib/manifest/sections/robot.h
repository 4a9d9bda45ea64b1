// "robots": arms, their nominal and their calibrated links.
#pragma once
#include <string>
#include <vector>

#include "geom/dh_row.h"

namespace gonio::manifest {

using gonio::DhRow;

struct Robot {              // "robots"
  std::string model;        // a known arm (robot/kinematics.h), or "dh" with `dh`
  std::vector<DhRow> dh;    // instead of the model's nominal values
  std::string calibration;  // file id of a UR controller's calibration.conf: deltas on the nominal values
};

}  // namespace gonio::manifest
