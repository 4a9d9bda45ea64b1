// The arm of a simulated laboratory as it truly is: where its joints stand at any moment of simulated time, which runs
// `time_factor` times as fast as ours. Its controller's servers show it; who renders pictures asks it. The encoders'
// angles are meant: what mounts, zeros and sag make of them is the matter of who asks.
//
// A motion is a straight line in joint space with a trapezoid of speed of the leading axis: s(t) along the line, from
// rest to rest, acceleration a, cruising speed v (Spong, Hutchinson & Vidyasagar 2006, section 5.5.2). A stop brakes
// along that line.
#pragma once
#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/desk/faults.h"

namespace gonio::acquisition::desk {

using SixJoints = std::array<double, 6>;

// Distance gone after `t` seconds on a way of length `distance`, and the speed then.
struct Trapezoid {
  double distance = 0, speed = 1, acceleration = 1;
  double duration() const;
  double gone(double t) const;
  double speed_at(double t) const;
};

struct TrueArmSettings {
  SixJoints joints_rad{}, lower_rad, upper_rad;  // where it begins; its range
  double time_factor = 1;
  double ambient_C = 22, warm_rise_C = 12, warm_time_s = 2400;  // joints warm up with power on
  double encoder_noise_rad = 0;
  std::function<SixJoints(const SixJoints&)>
      tool_pose;  // metres and rotation vector of the tool in the base; may be none
  TrueArmSettings() { lower_rad.fill(-6.2832), upper_rad.fill(6.2832); }
};

// One statement of a program.
struct ArmStep {
  enum class Kind { mark, move, brake, only_if } kind = Kind::mark;
  int output_register = 0, value = 0;       // mark; only_if: the rest is done where the register holds the value
  SixJoints target_rad{};                   // move
  double speed = 1.05, acceleration = 1.4;  // of the leading axis; brake: acceleration
};

struct ArmSnapshot {
  double time_s = 0;
  SixJoints joints_rad{}, speed_rad_per_s{}, tool{}, temperature_C{};
  bool powered = true, protective_stop = false, emergency_stop = false, remote_control = true, program_running = false;
  std::array<std::int32_t, 48> output_registers{};
};

class TrueArm {
 public:
  TrueArm(const TrueArmSettings& settings, Faults& faults);
  ArmSnapshot now();
  void run(
      const std::vector<ArmStep>& program);  // replaces the one that runs; braking first. Ignored where it may not.
  void protective_stop();
  void emergency_stop();
  void end_program();  // as by the stop key of its pendant: it brakes, and nothing else shows
  void clear_stops();
  void set_powered(bool powered);
  void set_remote_control(bool remote);
  std::int64_t programs() const;

 private:
  struct Leg {  // from rest to rest along a line, from `begin_s` on
    SixJoints from{}, to{};
    double begin_s = 0;
    Trapezoid profile;
    double end_s() const { return begin_s + profile.duration(); }
  };
  double simulated_now() const;
  void advance(double t);
  void next_step(double t);
  void brake(double t, double acceleration);
  void halt(double t);
  SixJoints joints_at(double t) const;
  SixJoints speeds_at(double t) const;

  const TrueArmSettings settings_;
  Faults& faults_;
  const std::chrono::steady_clock::time_point began_;
  mutable std::mutex mutex_;
  SixJoints rest_rad_;
  std::optional<Leg> leg_;
  double stop_at_s_ = -1;  // where a protective stop is due
  std::vector<ArmStep> program_;
  std::size_t step_ = 0;
  ArmSnapshot flags_;  // its flags and registers
  std::int64_t programs_ = 0;
  Random noise_;
};

}  // namespace gonio::acquisition::desk
