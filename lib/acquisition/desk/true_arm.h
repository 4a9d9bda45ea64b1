// The arm of a simulated laboratory as it truly is: where its joints stand at any moment of the laboratory's time. Its
// controller's servers show it, and so does the device within one program; who renders pictures asks it. The encoders'
// angles are meant: what mounts, zeros and sag make of them is the matter of who asks.
//
// A motion is a straight line in joint space with a trapezoid of speed of the leading axis (trapezoid.h). A stop brakes
// along that line.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/desk/desk_clock.h"
#include "acquisition/desk/faults.h"
#include "acquisition/desk/trapezoid.h"

namespace gonio::acquisition::desk {

using JointAngles = std::vector<double>;

using ToolPose = std::array<double, 6>;

struct TrueArmSettings {
  JointAngles joints_rad;            // where it begins
  JointAngles lower_rad, upper_rad;  // its range; empty: none
  double encoder_noise_rad = 0;
  std::function<ToolPose(const JointAngles&)> tool_pose;  // metres, rotation vector of the tool in the base; or none
};

// One statement of a program.
struct ArmStep {
  enum class Kind { mark, move, brake, only_if } kind = Kind::mark;
  int output_register = 0, value = 0;       // mark; only_if: the rest is done where the register holds the value
  JointAngles target_rad{};                 // move
  double speed = 1.05, acceleration = 1.4;  // of the leading axis; brake: acceleration
};

struct ArmSnapshot {
  double time_s = 0;
  JointAngles joints_rad{}, speed_rad_per_s{}, temperature_C{};
  std::vector<int> approach{};  // how each joint last turned: 1 forwards, -1 backwards, 0 not yet
  ToolPose tool{};
  bool powered = true, protective_stop = false, emergency_stop = false, remote_control = true, program_running = false;
  std::array<std::int32_t, 48> output_registers{};
};

class TrueArm {
 public:
  TrueArm(const TrueArmSettings& settings, const DeskClock& clock, Faults& faults);  // both are kept by reference
  ArmSnapshot now();
  void run(
      const std::vector<ArmStep>& program);  // replaces the one that runs; braking first. Ignored where it may not.
  void protective_stop();
  void emergency_stop();
  // Until the motion that is under way has ended; what the program does after it is not looked at.
  double time_left_s();
  void end_program();  // as by the stop key of its pendant: it brakes, and nothing else shows
  void clear_stops();
  void set_powered(bool powered);
  void set_remote_control(bool remote);
  std::int64_t programs() const;

 private:
  struct Leg {  // from rest to rest along a line, from `begin_s` on
    JointAngles from, to;
    double begin_s = 0;
    Trapezoid profile;
    double end_s() const { return begin_s + profile.duration(); }
  };
  void advance(double t);
  void next_step(double t);
  void brake(double t, double acceleration);
  void halt(double t);
  JointAngles joints_at(double t) const;
  JointAngles speeds_at(double t) const;

  const TrueArmSettings settings_;
  Faults& faults_;
  const DeskClock& clock_;
  mutable std::mutex mutex_;
  JointAngles rest_rad_;
  std::vector<int> approach_;
  std::optional<Leg> leg_;
  double stop_at_s_ = -1;  // where a protective stop is due
  std::vector<ArmStep> program_;
  std::size_t step_ = 0;
  ArmSnapshot flags_;  // its flags and registers
  std::int64_t programs_ = 0;
  Random noise_;
};

}  // namespace gonio::acquisition::desk
