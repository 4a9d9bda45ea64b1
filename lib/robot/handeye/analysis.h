// A whole hand-eye calibration: outliers, closed forms, joint refinement, what can be observed, errors at poses that
// were left out, where the scatter comes from, and what to add. Everything that the manifest and the page show.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "robot/handeye/consensus.h"
#include "robot/handeye/held_out.h"
#include "robot/handeye/observability.h"

namespace gonio::robot::handeye {

struct Parts {  // of the scatter of the board's middle over the poses, three coordinates together
  double robot_m = 0, camera_m = 0, unexplained_m = 0;
};
struct Analysis {
  std::string method;         // "joint", or the closed form that was asked for
  std::string best_closed;    // closed form with the least error of position at poses left out
  Solution solution, closed;  // of `method`; of best_closed
  Consensus consensus;
  Observability observability;
  std::vector<HeldOutErrors> held_out;     // joint, reprojection, then the closed forms; empty below four poses
  std::vector<HeldOutView> before, after;  // every view's error under `closed` and under `solution`
  PoseError scatter;                       // of `solution` over the views that count
  double rms_px = 0;
  Parts parts;
  double inverted_ratio = 0;  // scatter over that with the robot's poses inverted: above 1, the inverse fits better
  std::vector<std::string> next, complaints;

  const HeldOutErrors* held_out_of(const std::string& name) const;
  // At a pose not seen, the board's middle through the robot lies within this at 95 %; none below four poses.
  std::optional<double> within_m() const;
};
// At least three views. `views` must have pose_by_camera() as camera_from_board.
Analysis analyse(const Setup& setup, const std::vector<View>& views, const std::string& method);

}  // namespace gonio::robot::handeye
