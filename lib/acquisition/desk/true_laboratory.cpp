// The desk's devices. See true_laboratory.h.
#include "acquisition/desk/true_laboratory.h"

#include <algorithm>
#include <cmath>

#include "acquisition/desk/true_state.h"
#include "acquisition/desk/ur_controller.h"
#include "acquisition/device/urscript.h"
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
    const desk::ArmSnapshot now = arm().now();
    RobotState s;
    s.time_s = now.time_s;
    s.joints_rad = now.joints_rad;
    s.speed_rad_per_s = now.speed_rad_per_s;
    for (const double celsius : now.temperature_C) s.temperature_K.push_back(celsius + 273.15);
    s.base_from_tool = robot::flange(state_->laboratory.arms.at(name_).links, s.joints_rad);
    s.powered = s.standing = s.remote_control = true;
    s.mode = "simulated";
    return s;
  }

  // The arm runs the very program that it would get over the network: its joints end at the same bits.
  RobotState move(std::span<const Joints> way, std::span<const double> speeds,
                  std::span<const double> accelerations) override {
    {
      const std::lock_guard lock(state_->busy);
      for (const Joints& to : way)
        if (to.size() != arm().now().joints_rad.size())
          throw Error(Exit::data, "robot " + name_, "is sent to joints that it has not");
      ProgramMark mark;
      mark.before = arm().now().output_registers.at(static_cast<std::size_t>(mark.output_register));
      mark.number = mark.before / 2 + 1;
      arm().run(desk::steps_of_script(motion_script(mark, way, speeds, accelerations)));
      while (arm().now().program_running) state_->clock.pass(std::max(arm().time_left_s(), 1e-9));
    }
    RobotState end = state();
    double off = 0;
    for (std::size_t j = 0; !way.empty() && j < end.joints_rad.size(); ++j)
      off = std::max(off, std::abs(end.joints_rad[j] - way.back()[j]));
    if (off <= 1e-9) return end;
    throw Error(Exit::unavailable, "robot " + name_, "did not arrive where it was sent");
  }
  void stop() override {}

 private:
  desk::TrueArm& arm() { return *state_->arms.at(name_); }
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
    state_->lamps.set(state_->lamp_number.at(name_), on);
  }
  bool is_on() override {
    const std::lock_guard lock(state_->busy);
    return state_->lamps.lit(state_->lamp_number.at(name_));
  }

  bool answers() const override { return true; }

 private:
  Shared state_;
  std::string name_;
};

class DeskTurntable : public TurntableDevice {
 public:
  DeskTurntable(Shared state, std::string name) : state_(std::move(state)), name_(std::move(name)) {}
  double angle_rad() override {
    const std::lock_guard lock(state_->busy);
    return state_->tables.at(name_)->angle_rad();
  }
  double turn_to(double angle) override {
    const std::lock_guard lock(state_->busy);
    desk::TrueTurntable& table = *state_->tables.at(name_);
    table.turn_to(angle);
    while (table.time_left_s() > 0) state_->clock.pass(std::max(table.time_left_s(), 1e-9));
    return table.angle_rad();
  }
  void stop() override {}

 private:
  Shared state_;
  std::string name_;
};

class DeskScreen : public ScreenDevice {
 public:
  DeskScreen(Shared state, std::string name) : state_(std::move(state)), name_(std::move(name)) {}
  void show(const std::string& picture) override {
    const std::lock_guard lock(state_->busy);
    state_->show(name_, picture);
  }

 private:
  Shared state_;
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
  for (const auto& [name, screen] : lab.screens) instrument.screens[name] = std::make_unique<DeskScreen>(state, name);
  instrument.clock_s = [state] {
    const std::lock_guard lock(state->busy);
    return state->clock.now_s();
  };
  return instrument;
}

}  // namespace gonio::acquisition
