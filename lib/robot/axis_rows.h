// Denavit and Hartenberg's rows of any arm with revolute joints, from the lines its axes lie on: common normals from
// each axis to the next, and from the last to the flange's z (Spong, Hutchinson & Vidyasagar 2006, section 3.2). What
// rows cannot hold, where axis 1 is not the base's z and where the flange's x lies, stays as constant motions at both
// ends:
//
//   base_from_flange(q) = base_from_first  flange(links, q)  last_from_flange
#pragma once
#include <span>
#include <vector>

#include "geom/rigid.h"
#include "robot/kinematics.h"

namespace gonio::robot {

struct AxisLine {  // with all joints at zero, in the base
  Vec3 direction, through_m;
};

struct ChainRows {
  Rigid<frame::Base, frame::Base> base_from_first;
  std::vector<Link> links;
  Rigid<frame::Tool, frame::Tool> last_from_flange;
};

// `flange_at_zero`: base_from_flange. Axes within 1.5e-8 rad of parallel become parallel (then rows are wrong by as
// much times their distance; beyond, their normals lie so far out that rounding costs as much).
ChainRows rows_of(std::span<const AxisLine> axes, const Rigid<frame::Base, frame::Tool>& flange_at_zero);

}  // namespace gonio::robot
