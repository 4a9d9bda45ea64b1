#include "acquisition/plan/configurations.h"

#include <algorithm>
#include <cmath>

#include "acquisition/motion/way.h"
#include "base/error.h"

namespace gonio::acquisition {

Configurations::Configurations(const Laboratory& laboratory) : tool_speed_(laboratory.speed_m_per_s) {
  for (const auto& [name, arm] : laboratory.arms) {
    arms_.push_back({name, home_.size(), arm.home.size(), &arm});
    for (std::size_t j = 0; j < arm.limits.size(); ++j) {
      const robot::JointLimit& limit = arm.limits[j];
      auto at = std::ranges::find_if(alike_, [&limit](const Alike& a) {
        return a.speed == limit.speed_rad_per_s && a.acceleration == limit.acceleration_rad_per_s2;
      });
      if (at == alike_.end())
        at = alike_.insert(alike_.end(), Alike{limit.speed_rad_per_s, limit.acceleration_rad_per_s2, {}});
      at->joints.push_back(home_.size() + j);
    }
    home_.insert(home_.end(), arm.home.begin(), arm.home.end());
  }
}

const Configurations::Arm& Configurations::find(const std::string& name) const {
  const auto at = std::ranges::find(arms_, name, &Arm::name);
  if (at == arms_.end()) throw Error(Exit::internal, name, "no arm of the laboratory");
  return *at;
}

State Configurations::state(const Configuration& joints) const {
  State state;
  for (const Arm& arm : arms_) state[arm.name] = of(joints, arm.name);
  return state;
}

Configuration Configurations::packed(const State& state) const {
  Configuration joints = home_;
  for (const auto& [name, of_arm] : state) put(joints, name, of_arm);
  return joints;
}

void Configurations::put(Configuration& joints, const std::string& name, const Joints& of_arm) const {
  std::ranges::copy(of_arm, joints.begin() + static_cast<std::ptrdiff_t>(find(name).first));
}

Joints Configurations::of(const Configuration& joints, const std::string& name) const {
  const Arm& arm = find(name);
  const auto first = joints.begin() + static_cast<std::ptrdiff_t>(arm.first);
  return {first, first + static_cast<std::ptrdiff_t>(arm.count)};
}

Configurations::Placed Configurations::placed(Configuration joints) const {
  Placed placed{std::move(joints), {}};
  for (const Arm& arm : arms_)
    placed.tools_m.push_back(world_from_tool(*arm.arm, of(placed.joints, arm.name)).translation_m);
  return placed;
}

double Configurations::time(const Placed& from, const Placed& to) const {
  double slowest = 0;
  for (const Alike& alike : alike_) {
    double turn = 0;
    for (const std::size_t j : alike.joints) turn = std::max(turn, std::abs(to.joints[j] - from.joints[j]));
    if (turn > 0) slowest = std::max(slowest, trapezoid_time(turn, alike.speed, alike.acceleration));
  }
  for (std::size_t a = 0; a < arms_.size(); ++a)
    slowest = std::max(slowest, norm(to.tools_m[a] - from.tools_m[a]) / tool_speed_);
  return slowest;
}

double Configurations::largest_turn(const Placed& from, const Placed& to) const {
  double turn = 0;
  for (std::size_t j = 0; j < from.joints.size(); ++j) turn = std::max(turn, std::abs(to.joints[j] - from.joints[j]));
  return turn;
}

}  // namespace gonio::acquisition
