// See turns.h.
#include "robot/inverse/turns.h"

#include <algorithm>
#include <cmath>

namespace gonio::robot {
namespace {

constexpr double whole_turn = 2 * pi;
constexpr double rounding_rad = 1e-9;  // an angle so little beyond its limit stands at it

JointLimit limit_of(std::span<const JointLimit> limits, std::size_t joint) {
  return joint < limits.size() ? limits[joint] : JointLimit{};
}

// Angles of one joint inside its limits, nearest first.
std::vector<double> angles_of(double angle_rad, double near_rad, const JointLimit& limit) {
  const double nearest = angle_rad + whole_turn * std::round((near_rad - angle_rad) / whole_turn);
  if (!std::isfinite(limit.lower_rad) || !std::isfinite(limit.upper_rad)) {
    // Without one of its ends: the nearest turn that the other allows.
    double a = nearest;
    if (a < limit.lower_rad - rounding_rad)
      a += whole_turn * std::ceil((limit.lower_rad - rounding_rad - a) / whole_turn);
    if (a > limit.upper_rad + rounding_rad)
      a -= whole_turn * std::ceil((a - limit.upper_rad - rounding_rad) / whole_turn);
    return {a};
  }
  std::vector<double> angles;
  double a = angle_rad + whole_turn * std::ceil((limit.lower_rad - rounding_rad - angle_rad) / whole_turn);
  for (; a <= limit.upper_rad + rounding_rad; a += whole_turn)
    angles.push_back(std::clamp(a, limit.lower_rad, limit.upper_rad));
  std::stable_sort(angles.begin(), angles.end(),
                   [&](double x, double y) { return std::abs(x - near_rad) < std::abs(y - near_rad); });
  return angles;
}

}  // namespace

std::optional<Joints> with_turns(const Joints& joints_rad, const Joints& near_rad, std::span<const JointLimit> limits) {
  Joints turned{};
  for (std::size_t i = 0; i < 6; ++i) {
    const auto angles = angles_of(joints_rad[i], near_rad[i], limit_of(limits, i));
    if (angles.empty()) return std::nullopt;
    turned[i] = angles.front();
  }
  return turned;
}

std::vector<Joints> all_turns(const Joints& joints_rad, const Joints& near_rad, std::span<const JointLimit> limits) {
  std::vector<Joints> all = {Joints{}};
  for (std::size_t i = 0; i < 6; ++i) {
    std::vector<Joints> longer;
    for (const double angle : angles_of(joints_rad[i], near_rad[i], limit_of(limits, i)))
      for (Joints joints : all) {
        joints[i] = angle;
        longer.push_back(joints);
      }
    all = std::move(longer);
  }
  const auto step = [&](const Joints& joints) {
    double largest = 0;
    for (std::size_t i = 0; i < 6; ++i) largest = std::max(largest, std::abs(joints[i] - near_rad[i]));
    return largest;
  };
  std::stable_sort(all.begin(), all.end(), [&](const Joints& a, const Joints& b) { return step(a) < step(b); });
  return all;
}

}  // namespace gonio::robot
