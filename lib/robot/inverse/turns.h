// Whole turns: an answer of the inverse kinematics is known up to multiples of 2 pi in each joint.
#pragma once
#include <optional>
#include <span>
#include <vector>

#include "robot/inverse/inverse_kinematics.h"
#include "robot/limits.h"

namespace gonio::robot {

// Each joint, turned by whole turns, as near to `near_rad` as its limits allow; none where a joint has no angle inside
// its limits. A joint without limits (both infinite) is wherever is nearest.
std::optional<Joints> with_turns(const Joints& joints_rad, const Joints& near_rad, std::span<const JointLimit> limits);

// All of them inside the limits, nearest to `near_rad` first (largest joint step decides). A joint without limits takes
// its nearest turn only.
std::vector<Joints> all_turns(const Joints& joints_rad, const Joints& near_rad, std::span<const JointLimit> limits);

}  // namespace gonio::robot
