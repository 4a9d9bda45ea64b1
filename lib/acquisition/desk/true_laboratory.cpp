// The desk's devices. See true_laboratory.h.
#include "acquisition/desk/true_laboratory.h"

#include <algorithm>
#include <cmath>

#include "acquisition/desk/true_state.h"
#include "acquisition/motion/way.h"
#include "base/error.h"
#include "manifest/sections/laboratory.h"

namespace gonio::acquisition {
namespace {

using Shared = std::shared_ptr<TrueState>;

class DeskRobot : public RobotDevice {
 public:
  DeskRobot(Shared state, std::string name) : state_(std::move(state)), name_(std::move(name)) {}

  RobotState state() override {
    const std::lock_guard lock(state_->busy);
    RobotState s;
    s.time_s = state_->time_s;
    s.joints_rad = state_->joints.at(name_);
    s.speed_rad_per_s.assign(s.joints_rad.size(), 0);
    s.temperature_K.assign(s.joints_rad.size(), 293.15 + warmth_K(state_->time_s));
    s.base_from_tool = robot::flange(state_->laboratory.arms.at(name_).links, s.joints_rad);
    s.powered = s.standing = s.remote_control = true;
    s.mode = "simulated";
    return s;
  }

  RobotState move(std::span<const Joints> way, std::span<const double> speeds,
                  std::span<const double> accelerations) override {
    {
      const std::lock_guard lock(state_->busy);
      Joints& now = state_->joints.at(name_);
      for (const Joints& to : way) {
        if (to.size() != now.size()) throw Error(Exit::data, "robot " + name_, "is sent to joints that it has not");
        double longest = 0;
        for (std::size_t j = 0; j < now.size(); ++j) {
          const double turn = to[j] - now[j];
          longest = std::max(longest, trapezoid_time(std::abs(turn), speeds[j], accelerations[j]));
          if (std::abs(turn) > 1e-9 && j < 6) state_->approach[name_][j] = turn > 0 ? 1 : -1;
        }
        state_->time_s += longest;
        now = to;
      }
    }
    return state();
  }
  void stop() override {}

 private:
  Shared state_;
  std::string name_;
};

class DeskCamera : public CameraDevice {
 public:
  DeskCamera(Shared state, std::string name) : state_(std::move(state)), name_(std::move(name)) {}
  std::string identity() override { return "simulated camera " + name_; }
  RawFrame take(const Shot& shot) override {
    const std::lock_guard lock(state_->busy);
    return state_->expose(name_, shot);
  }

 private:
  Shared state_;
  std::string name_;
};

class DeskLamp : public LampDevice {
 public:
  DeskLamp(Shared state, std::string name) : state_(std::move(state)), name_(std::move(name)) {}
  void set(bool on) override {
    const std::lock_guard lock(state_->busy);
    state_->lit.at(name_) = on;
  }
  bool is_on() override {
    const std::lock_guard lock(state_->busy);
    return state_->lit.at(name_);
  }

 private:
  Shared state_;
  std::string name_;
};

class DeskTurntable : public TurntableDevice {
 public:
  DeskTurntable(Shared state, std::string name) : state_(std::move(state)), name_(std::move(name)) {}
  double angle_rad() override {
    const std::lock_guard lock(state_->busy);
    return state_->angle_rad.at(name_);
  }
  double turn_to(double angle) override {
    const std::lock_guard lock(state_->busy);
    const auto& table = state_->document.laboratory.entry.front().turntables.at(name_);
    state_->time_s += trapezoid_time(std::abs(angle - state_->angle_rad.at(name_)), table.speed_rad_per_s.value_or(0.5),
                                     table.acceleration_rad_per_s2.value_or(1));
    return state_->angle_rad.at(name_) = angle;
  }
  void stop() override {}

 private:
  Shared state_;
  std::string name_;
};

class DeskScreen : public ScreenDevice {
 public:
  explicit DeskScreen(std::string name) : name_(std::move(name)) {}
  void show(const std::string& picture) override {
    if (!picture.empty())
      throw Error(Exit::unavailable, "screen " + name_, "shows nothing but black in a simulated laboratory",
                  "leave screens out of the plan");
  }

 private:
  std::string name_;
};

}  // namespace

Instrument desk_instrument(const manifest::Document& believed, const manifest::Document* truth,
                           const DeskOptions& options) {
  const auto state = std::make_shared<TrueState>(believed, truth, options);
  Instrument instrument;
  for (const auto& [name, arm] : state->laboratory.arms)
    instrument.robots[name] = std::make_unique<DeskRobot>(state, name);
  const manifest::Laboratory& lab = state->document.laboratory.entry.front();
  for (const auto& [name, camera] : lab.cameras) {
    if (!manifest::has_entry(state->document, "cameras", name))
      throw Error(Exit::data, manifest::place(believed, "/laboratory/cameras/" + name), "has no lens in cameras",
                  "enter it there under its name");
    instrument.cameras[name] = std::make_unique<DeskCamera>(state, name);
  }
  for (const auto& [name, lamp] : lab.lamps) instrument.lamps[name] = std::make_unique<DeskLamp>(state, name);
  for (const auto& [name, table] : lab.turntables)
    instrument.turntables[name] = std::make_unique<DeskTurntable>(state, name);
  for (const auto& [name, screen] : lab.screens) instrument.screens[name] = std::make_unique<DeskScreen>(name);
  instrument.clock_s = [state] {
    const std::lock_guard lock(state->busy);
    return state->time_s;
  };
  return instrument;
}

}  // namespace gonio::acquisition
