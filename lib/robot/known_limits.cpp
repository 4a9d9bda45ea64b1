// Limits of the known arms (limits.h). Universal Robots: ranges and speeds of the maker's ROS description
// (Universal_Robots_ROS2_Description, config/*/joint_limits.yaml); its elbow could turn as far as the other joints, but
// half a turn either way is all that it reaches without hitting itself. ABB: ROS-Industrial's abb_irb1600_support (URDF
// of either arm and joint_limits.yaml; where their speeds differ, the smaller).
#include "base/error.h"
#include "geom/angle.h"
#include "robot/limits.h"

namespace gonio::robot {
namespace {

constexpr double assumed_acceleration = 5;  // rad/s^2
constexpr const char* universal_acceleration =
    "assumed: 5 rad/s^2, the maker's MoveIt configuration, which calls it conservative; the arms limit torques only";
constexpr const char* abb_acceleration = "assumed: 5 rad/s^2 as for Universal Robots; the maker publishes none";

ArmLimits universal_limits(const char* name, double shoulder_deg_per_s, double elbow_deg_per_s, double wrist_deg_per_s,
                           bool endless = false) {
  ArmLimits limits{name, {}, "Universal Robots, ROS description, joint_limits.yaml", universal_acceleration};
  for (int i = 0; i < 6; ++i) {
    const double speed = i < 2 ? shoulder_deg_per_s : i == 2 ? elbow_deg_per_s : wrist_deg_per_s;
    JointLimit limit{-2 * pi, 2 * pi, speed * degree, assumed_acceleration};
    if (i == 2) limit.lower_rad = -pi, limit.upper_rad = pi;
    if (i == 5 && endless)
      limit = {JointLimit{}.lower_rad, JointLimit{}.upper_rad, speed * degree, assumed_acceleration};
    limits.joints.push_back(limit);
  }
  return limits;
}

struct Range {
  double lower_rad, upper_rad;
};

ArmLimits abb_limits(const char* name, Range second, Range third) {
  const Range ranges[] = {{-pi, pi}, second, third, {-3.4906, 3.4906}, {-2.0071, 2.0071}, {-6.9813, 6.9813}};
  const double speeds[] = {2.618, 2.7925, 2.967, 5.585, 6.9813, 7.854};
  ArmLimits limits{name, {}, "ROS-Industrial, abb_irb1600_support", abb_acceleration};
  for (int i = 0; i < 6; ++i)
    limits.joints.push_back({ranges[i].lower_rad, ranges[i].upper_rad, speeds[i], assumed_acceleration});
  return limits;
}

}  // namespace

std::span<const ArmLimits> known_limits() {
  static const std::vector<ArmLimits> all = {
      universal_limits("ur3", 180, 180, 360, true),
      universal_limits("ur3e", 180, 180, 360, true),
      universal_limits("ur5", 180, 180, 180),
      universal_limits("ur5e", 180, 180, 180),
      universal_limits("ur10e", 120, 180, 180),
      abb_limits("abb-irb-1600", {-pi / 2, 2.0944}, {-4.27601, 1.1344}),
      abb_limits("abb-irb-1600-1.2", {-1.0995, 1.9198}, {-4.1015, 0.9599}),
  };
  return all;
}

const ArmLimits& known_limits_of(const std::string& arm, const std::string& place) {
  std::string names;
  for (const ArmLimits& limits : known_limits()) {
    if (limits.name == arm) return limits;
    names += (names.empty() ? "" : ", ") + limits.name;
  }
  throw Error(Exit::data, place, "no joint limits are known for \"" + arm + "\"",
              "give the arm's limits, or its URDF; known are " + names);
}

}  // namespace gonio::robot
