// See arm_mover.h.
#include "acquisition/run/arm_mover.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <thread>

#include "base/error.h"
#include "base/text.h"

namespace gonio::acquisition {
namespace {

constexpr double as_before_rad = 1e-3;  // readings of an arm that stands differ by less
constexpr double ahead = 0.2;           // of one motion: how far arms that move together may be apart

double farthest(const Joints& a, const Joints& b) {
  double most = 0;
  for (std::size_t j = 0; j < a.size(); ++j) most = std::max(most, std::abs(a[j] - b[j]));
  return most;
}

std::vector<std::string> moving_arms(const State& from, const State& to) {
  std::vector<std::string> names;
  for (const auto& [name, joints] : from)
    if (const auto there = to.find(name); there != to.end() && farthest(joints, there->second) > 1e-9)
      names.push_back(name);
  return names;
}

Joints between(const Joints& a, const Joints& b, double share) {
  Joints q(a.size());
  for (std::size_t j = 0; j < a.size(); ++j) q[j] = a[j] + share * (b[j] - a[j]);
  return q;
}

// Is the motion free though `first` and `second` be apart by `ahead` of it?
bool free_though_apart(const Laboratory& lab, const Surroundings& around, const State& from, const State& to,
                       const std::string& first, const std::string& second) {
  const double turn = std::max(farthest(from.at(first), to.at(first)), farthest(from.at(second), to.at(second)));
  const int steps = std::max(10, static_cast<int>(std::ceil(turn / 0.02)));
  for (int i = 0; i <= steps; ++i)
    for (const double lead : {-ahead, -0.5 * ahead, 0.5 * ahead, ahead}) {
      const double s = static_cast<double>(i) / steps, t = std::clamp(s + lead, 0.0, 1.0);
      State state = from;
      state[first] = between(from.at(first), to.at(first), s);
      state[second] = between(from.at(second), to.at(second), t);
      if (!around.free(state, lab.margin_m)) return false;
    }
  return true;
}

// How much slower than its joints could the arm must go for its tool to keep the limit.
double slower_for_tool(const Laboratory& lab, const LaboratoryArm& arm, const Joints& from, const Joints& to) {
  double per_share = 0;  // m of the tool's way per share of the line
  const int steps = std::max(8, static_cast<int>(std::ceil(farthest(from, to) / 0.05)));
  Vec3 last = world_from_tool(arm, from).translation_m;
  for (int i = 1; i <= steps; ++i) {
    const Vec3 now = world_from_tool(arm, between(from, to, static_cast<double>(i) / steps)).translation_m;
    per_share = std::max(per_share, norm(now - last) * steps);
    last = now;
  }
  double shares_per_s = 1e300;  // at full speed
  for (std::size_t j = 0; j < from.size(); ++j)
    if (const double turn = std::abs(to[j] - from[j]); turn > 1e-12) {
      const double peak =
          std::min(arm.limits[j].speed_rad_per_s, std::sqrt(turn * arm.limits[j].acceleration_rad_per_s2));
      shares_per_s = std::min(shares_per_s, peak / turn);
    }
  return std::max(1.0, per_share * shares_per_s / lab.speed_m_per_s);
}

}  // namespace

State ArmMover::stands() {
  State state;
  for (const auto& [name, arm] : laboratory_.arms) {
    const auto device = instrument_.robots.find(name);
    if (device == instrument_.robots.end()) continue;
    const RobotState now = device->second->state();
    const std::string who = "robot " + name;
    if (now.emergency_stop) throw Error(Exit::unavailable, who, "is in emergency stop", "release it at the panel");
    if (now.protective_stop)
      throw Error(Exit::unavailable, who, "is in protective stop", "look what it touched, then unlock it at the panel");
    if (!now.powered) throw Error(Exit::unavailable, who, "has no power on its joints", "switch it on at the panel");
    if (!now.standing)
      throw Error(Exit::unavailable, who, "is moving though nobody told it to", "stop it at the panel");
    if (now.joints_rad.size() != arm.links.size())
      throw Error(Exit::unavailable, who,
                  format("says %zu joint angles, its model has %zu", now.joints_rad.size(), arm.links.size()),
                  "correct its model in the laboratory");
    state[name] = now.joints_rad;
  }
  return state;
}

void ArmMover::stop_all() noexcept {
  for (const auto& [name, device] : instrument_.robots) try {
      device->stop();
    } catch (...) {  // the others are still to be stopped
    }
}

void ArmMover::move_one(const std::string& name, const State& from, const State& to, double slower) {
  const LaboratoryArm& arm = laboratory_.arms.at(name);
  Joints speeds, accelerations;  // a motion stretched in time: speeds fall by the factor, accelerations by its square
  for (const robot::JointLimit& limit : arm.limits) {
    speeds.push_back(limit.speed_rad_per_s / slower);
    accelerations.push_back(limit.acceleration_rad_per_s2 / (slower * slower));
  }
  const std::vector<Joints> way{from.at(name), to.at(name)};
  const RobotState reached = instrument_.robots.at(name)->move(way, speeds, accelerations);
  const double off = farthest(reached.joints_rad, to.at(name));
  if (!reached.standing || off > as_before_rad)
    throw Error(Exit::unavailable, "robot " + name, format("stopped %.2f deg from where it was sent", off * 57.29578),
                "look at its panel");
}

void ArmMover::move_together(const State& from, const State& to) {
  const auto names = moving_arms(from, to);
  if (names.empty()) return;
  std::vector<double> times;
  for (const std::string& name : names) {
    const LaboratoryArm& arm = laboratory_.arms.at(name);
    times.push_back(line_time(arm, from.at(name), to.at(name)) *
                    slower_for_tool(laboratory_, arm, from.at(name), to.at(name)));
  }
  const double slowest = *std::ranges::max_element(times);
  const auto slower = [&](std::size_t i) {
    const LaboratoryArm& arm = laboratory_.arms.at(names[i]);
    return slowest / line_time(arm, from.at(names[i]), to.at(names[i]));
  };
  std::vector<std::exception_ptr> failures(names.size());
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < names.size(); ++i)
      threads.emplace_back([&, i] {
        try {
          move_one(names[i], from, to, slower(i));
        } catch (...) {
          failures[i] = std::current_exception();
          stop_all();
        }
      });
  }
  for (const auto& failure : failures)
    if (failure) std::rethrow_exception(failure);
}

void ArmMover::go(const Way& way) {
  if (way.size() < 2) return;
  const State now = stands();
  for (const auto& [name, joints] : way.front())
    if (const double off = now.contains(name) ? farthest(now.at(name), joints) : 0; off > as_before_rad)
      throw Error(Exit::data, "robot " + name, format("stands %.2f deg from where the way begins", off * 57.29578));
  const WayFigures figures = judge(laboratory_, surroundings_, way);
  if (!figures.fault.empty()) throw Error(Exit::data, "plan", "a way breaks a limit: " + figures.fault, "plan again");
  for (std::size_t i = 0; i + 1 < way.size(); ++i) {
    const State &from = way[i], &to = way[i + 1];
    const auto names = moving_arms(from, to);
    bool apart = true;
    for (std::size_t a = 0; a < names.size(); ++a)
      for (std::size_t b = a + 1; b < names.size(); ++b)
        apart = apart && free_though_apart(laboratory_, surroundings_, from, to, names[a], names[b]);
    if (apart) {
      move_together(from, to);
      continue;
    }
    // One after the other, in whichever order is free.
    std::vector<std::string> order = names;
    bool moved = false;
    do {
      Way turns{from};
      for (const std::string& name : order) {
        turns.push_back(turns.back());
        turns.back()[name] = to.at(name);
      }
      if (!judge(laboratory_, surroundings_, turns).fault.empty()) continue;
      for (std::size_t k = 0; k + 1 < turns.size(); ++k) move_together(turns[k], turns[k + 1]);
      moved = true;
    } while (!moved && std::ranges::next_permutation(order).found);
    if (!moved)
      throw Error(Exit::data, "plan", "the arms would meet if one of them were late",
                  "plan again with a larger margin");
  }
}

void ArmMover::return_to(const State& goal, std::uint64_t seed) {
  const State now = stands();
  if (moving_arms(now, goal).empty()) return;
  const Way line{now, goal};
  if (judge(laboratory_, surroundings_, line).fault.empty()) return go(line);
  const auto found = joint_way(laboratory_, surroundings_, now, goal, seed);
  if (!found)
    throw Error(Exit::unavailable, "robots", "no free way was found from where they stand",
                "move them to their home by hand, then go on with --resume");
  go(*found);
}

}  // namespace gonio::acquisition
