// A robot whose controller is reached through registers alone (register_map.h).
#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <random>
#include <thread>

#include "acquisition/device/connection.h"
#include "acquisition/device/register_map.h"
#include "base/error.h"
#include "base/text.h"

namespace gonio::acquisition {
namespace {

constexpr double same_place_rad = 1e-4;  // devices.h; coarser where the registers are

class RegisterRobot : public RobotDevice {
 public:
  RegisterRobot(const ModbusAddress& address, const RegisterMap& map, double stall_s, const std::string& place)
      : device_(address, place), map_(map), host_(address.host), place_(place), stall_s_(stall_s) {
    number_ = static_cast<int>(std::random_device{}() & 0x3FFF) + 1;
    for (int joint = 1; joint <= map_.joints; ++joint)
      tolerance_rad_ = std::max(tolerance_rad_, resolution(*map_.find("joint", joint)));
  }

  // Speeds say whether it stands, or the register of that name; without either two readings of the angles that agree
  // do.
  RobotState state() override {
    RegisterReading reading = read_registers(device_, map_);
    RobotState state;
    state.standing = reading.standing.value_or(true);
    for (const double speed : reading.speed_rad_per_s) state.standing = state.standing && std::abs(speed) <= 2e-3;
    if (!reading.standing && reading.speed_rad_per_s.empty()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
      const auto before = reading.joints_rad;
      reading = read_registers(device_, map_);
      state.standing = astray(reading.joints_rad, before, tolerance_rad_).empty();
    }
    state.time_s = std::chrono::duration<double>(Clock::now().time_since_epoch()).count();
    state.joints_rad = reading.joints_rad;
    state.speed_rad_per_s = reading.speed_rad_per_s;
    state.temperature_K = reading.temperature_K;
    state.protective_stop = reading.protective_stop.value_or(false);
    state.emergency_stop = reading.emergency_stop.value_or(false);
    state.powered = reading.powered.value_or(true);
    state.remote_control = reading.remote_control.value_or(true);
    state.mode = reading.mode ? "mode " + std::to_string(*reading.mode) : "";
    for (const double angle : state.joints_rad)
      if (!std::isfinite(angle))
        throw unavailable("a joint's register is no number", "check the map's types and words");
    return state;
  }

  RobotState move(std::span<const std::vector<double>> way, std::span<const double> speeds,
                  std::span<const double> accelerations) override {
    const std::lock_guard<std::mutex> lock(one_at_a_time_);
    const auto joints = static_cast<std::size_t>(map_.joints);
    if (way.empty() || speeds.size() != joints || accelerations.size() != joints)
      throw Error(Exit::internal, place_, "a motion that does not fit its arm");
    needs_motion();
    const RobotState before = state();
    refuse_stopped(before, "cannot move: ");
    if (!before.standing) throw unavailable("moves although nothing of ours is under way", "wait until it stands");
    if (!before.remote_control) throw unavailable("is not in remote control", "switch it at its pendant");
    if (const auto why = astray(before.joints_rad, way[0], std::max(1e-3, tolerance_rad_)); !why.empty())
      throw unavailable("is not where the way begins: " + why, "read its state and plan from there");
    const int stops_before = stops_;
    try {
      for (int joint = 1; joint <= map_.joints; ++joint) {
        set("speed-limit", joint, speeds[joint - 1]);
        set("acceleration-limit", joint, accelerations[joint - 1]);
      }
      RobotState now = before;
      for (std::size_t k = 1; k < way.size(); ++k) now = go(way[k], stops_before);
      return now;
    } catch (...) {
      if (stops_ == stops_before) brake();
      throw;
    }
  }

  void stop() override {
    ++stops_;
    const Register* which = map_.find("stop");
    if (which == nullptr) throw unavailable("its register map has no 'stop'", "press the emergency stop");
    write_register(device_, *which, 1);
    auto until = after(stall_s_);
    while (!state().standing)
      if (Clock::now() > until) throw unavailable("does not come to a stand", "press the emergency stop");
  }

 private:
  Error unavailable(const std::string& problem, const std::string& remedy) const {
    return Error(Exit::unavailable, place_, "robot at " + host_ + ": " + problem, remedy);
  }
  void brake() noexcept {
    try {
      stop();
    } catch (...) {
    }
  }
  void refuse_stopped(const RobotState& now, const std::string& before) const {
    if (now.protective_stop) throw unavailable(before + "protective stop", "clear it at its pendant");
    if (now.emergency_stop) throw unavailable(before + "emergency stop", "clear it at its pendant");
    if (!now.powered) throw unavailable(before + "no power", "switch its power on");
  }
  static std::string astray(std::span<const double> joints, std::span<const double> wanted, double limit_rad) {
    for (std::size_t i = 0; i < wanted.size(); ++i)
      if (!(std::abs(joints[i] - wanted[i]) <= limit_rad))
        return format("joint %d stands at %.6f rad instead of %.6f (limit %g)", static_cast<int>(i + 1), joints[i],
                      wanted[i], limit_rad);
    return {};
  }
  void needs_motion() const {
    std::string missing;
    for (const char* name : {"command", "done", "stop"})
      if (map_.find(name) == nullptr) missing += std::string(missing.empty() ? "" : ", ") + name;
    for (int joint = 1; joint <= map_.joints; ++joint)
      if (map_.find("target", joint) == nullptr)
        missing += (missing.empty() ? "target-" : ", target-") + std::to_string(joint);
    if (!missing.empty())
      throw unavailable("its register map has no " + missing, "without them its state can be read, no more");
  }
  // What is not in the map is not set; what is set is read back.
  void set(const char* name, int joint, double value) {
    const Register* which = map_.find(name, joint);
    if (which == nullptr) return;
    write_register(device_, *which, value);
    const double kept = read_register(device_, *which);
    if (!(std::abs(kept - value) <= resolution(*which) + 1e-6 * std::abs(value)))
      throw unavailable(format("keeps %g as %s-%d, sent was %g", kept, name, joint, value),
                        "check the map's type and scale");
  }

  RobotState go(const std::vector<double>& target, int stops_before) {
    for (int joint = 1; joint <= map_.joints; ++joint) set("target", joint, target[joint - 1]);
    const Register &command = *map_.find("command"), &done = *map_.find("done");
    int number = number_++ & 0x7FFF;
    if (number == 0 || number == static_cast<int>(read_register(device_, done))) number = (number_++ & 0x7FFF) | 1;
    write_register(device_, command, number);
    auto moved = Clock::now();
    for (std::vector<double> last;;) {
      const bool arrived = static_cast<int>(read_register(device_, done)) == number;
      const RobotState now = state();
      if (stops_ != stops_before) throw unavailable("was stopped on request", {});
      refuse_stopped(now, "stopped on its way: ");
      const std::string why = astray(now.joints_rad, target, tolerance_rad_);
      if (arrived && now.standing && why.empty()) return now;
      if (now.joints_rad != last) moved = Clock::now();
      last = now.joints_rad;
      if (Clock::now() > moved + std::chrono::duration<double>(stall_s_))
        throw unavailable(
            format("does not move on for %g s; ", stall_s_) + (why.empty() ? "it does not say that it is done" : why),
            "look at its pendant's log");
    }
  }

  ModbusClient device_;
  RegisterMap map_;
  std::string host_, place_;
  double stall_s_, tolerance_rad_ = same_place_rad;
  std::mutex one_at_a_time_;
  std::atomic<int> number_{1}, stops_{0};
};

}  // namespace

std::unique_ptr<RobotDevice> make_register_robot(const ModbusAddress& address, const RegisterMap& map, double stall_s,
                                                 const std::string& place) {
  return std::make_unique<RegisterRobot>(address, map, stall_s, place);
}

}  // namespace gonio::acquisition
