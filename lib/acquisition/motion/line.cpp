// See line.h.
#include "acquisition/motion/line.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "robot/inverse/singularity.h"

namespace gonio::acquisition {
namespace {

std::string outside(const LaboratoryArm& arm, Vec3 flange, const std::pair<Vec3, Vec3>& box) {
  for (int i = 0; i < 3; ++i) {
    const bool low = flange[i] < box.first[i];
    if (low || flange[i] > box.second[i])
      return arm.name + "'s flange at " + "xyz"[i] +
             format(" = %.3f m, limit %.3f m", flange[i], low ? box.first[i] : box.second[i]);
  }
  return "";
}

}  // namespace

State between(const Laboratory& laboratory, const State& from, const State& to, double t) {
  State state;
  for (const auto& [name, arm] : laboratory.arms) {
    const Joints &a = joints_of(arm, from), &b = joints_of(arm, to);
    Joints& joints = state[name];
    joints.resize(a.size());
    for (std::size_t i = 0; i < a.size(); ++i) joints[i] = a[i] + t * (b[i] - a[i]);
  }
  return state;
}

double largest_turn(const Laboratory& laboratory, const State& from, const State& to) {
  double largest = 0;
  for (const auto& [name, arm] : laboratory.arms) {
    const Joints &a = joints_of(arm, from), &b = joints_of(arm, to);
    for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, std::fabs(b[i] - a[i]));
  }
  return largest;
}

double smallest_singular(const Laboratory& laboratory, const State& state) {
  double smallest = std::numeric_limits<double>::infinity();
  for (const auto& [name, arm] : laboratory.arms) {
    const Joints& joints = joints_of(arm, state);
    if (joints.size() != 6) continue;
    robot::Joints six{};
    std::copy(joints.begin(), joints.end(), six.begin());
    smallest = std::min(smallest, robot::smallest_singular_m(arm.links, six, singular_length_m));
  }
  return smallest;
}

std::string broken_at(const Laboratory& laboratory, const State& state, double singular_m) {
  for (const auto& [name, arm] : laboratory.arms) {
    const Joints& joints = joints_of(arm, state);
    if (const std::string broken = broken_limit(arm, joints); !broken.empty()) return name + ": " + broken;
    if (!laboratory.workspace) continue;
    const std::string left = outside(arm, world_from_tool(arm, joints).translation_m, *laboratory.workspace);
    if (!left.empty()) return left;
  }
  if (singular_m < laboratory.smallest_singular_m)
    return format("smallest singular value %.4f m, limit %.4f m", singular_m, laboratory.smallest_singular_m);
  return "";
}

}  // namespace gonio::acquisition
