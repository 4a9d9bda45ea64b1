// What an arm's joints may do: range, speed, acceleration.
#pragma once
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace gonio::robot {

struct JointLimit {
  double lower_rad = -std::numeric_limits<double>::infinity();
  double upper_rad = std::numeric_limits<double>::infinity();
  double speed_rad_per_s = std::numeric_limits<double>::infinity();
  double acceleration_rad_per_s2 = std::numeric_limits<double>::infinity();
};

struct ArmLimits {
  std::string name;  // of the arm (known_arms)
  std::vector<JointLimit> joints;
  std::string source;               // of ranges and speeds
  std::string acceleration_source;  // makers seldom give any: what was assumed
};

// One for every known arm.
std::span<const ArmLimits> known_limits();
// Error(data) at `place` that lists the names.
const ArmLimits& known_limits_of(const std::string& arm, const std::string& place);

}  // namespace gonio::robot
