#include "acquisition/desk/true_arm.h"

#include <algorithm>
#include <cmath>

namespace gonio::acquisition::desk {
namespace {

constexpr double hard_stop_rad_per_s2 = 20, limit_slack_rad = 1e-6;

double longest_turn(const JointAngles& from, const JointAngles& to) {
  double longest = 0;
  for (std::size_t i = 0; i < to.size(); ++i) longest = std::max(longest, std::abs(to[i] - from[i]));
  return longest;
}

}  // namespace

TrueArm::TrueArm(const TrueArmSettings& settings, const DeskClock& clock, Faults& faults)
    : settings_(settings),
      faults_(faults),
      clock_(clock),
      rest_rad_(settings.joints_rad),
      approach_(settings.joints_rad.size()),
      noise_(17) {}

JointAngles TrueArm::joints_at(double t) const {
  if (!leg_) return rest_rad_;
  const double share = leg_->profile.distance > 0 ? leg_->profile.gone(t - leg_->begin_s) / leg_->profile.distance : 1;
  if (share >= 1) return leg_->to;
  JointAngles joints(leg_->to.size());
  for (std::size_t i = 0; i < joints.size(); ++i) joints[i] = leg_->from[i] + share * (leg_->to[i] - leg_->from[i]);
  return joints;
}

JointAngles TrueArm::speeds_at(double t) const {
  JointAngles speeds(rest_rad_.size());
  if (!leg_ || leg_->profile.distance <= 0) return speeds;
  const double share = leg_->profile.speed_at(t - leg_->begin_s) / leg_->profile.distance;
  for (std::size_t i = 0; i < speeds.size(); ++i) speeds[i] = share * (leg_->to[i] - leg_->from[i]);
  return speeds;
}

// Braking from speed v takes v^2 / 2a along the line: the second half of a motion without cruise, of length v^2 / a.
void TrueArm::brake(double t, double acceleration) {
  if (!leg_) return;
  const JointAngles here = joints_at(t);
  const double v = leg_->profile.speed_at(t - leg_->begin_s), longest = leg_->profile.distance;
  if (v <= 0 || longest <= 0) {
    rest_rad_ = here;
    leg_.reset();
    return;
  }
  Leg rest;
  const double half = v * v / (2 * acceleration);
  rest.from = rest.to = here;
  for (std::size_t i = 0; i < here.size(); ++i) {
    const double direction = (leg_->to[i] - leg_->from[i]) / longest;
    rest.from[i] = here[i] - direction * half;
    rest.to[i] = here[i] + direction * half;
  }
  rest.profile = {2 * half, v, acceleration};
  rest.begin_s = t - v / acceleration;
  leg_ = rest;
}

// What follows at time t, the arm at rest. Marks take no time.
void TrueArm::next_step(double t) {
  while (step_ < program_.size() && !leg_) {
    const ArmStep& step = program_[step_++];
    if (step.kind == ArmStep::Kind::mark) flags_.output_registers.at(step.output_register) = step.value;
    if (step.kind != ArmStep::Kind::move) continue;
    bool beyond = faults_.strikes(Fault::joint_limit);
    beyond = beyond || step.target_rad.size() != rest_rad_.size();
    for (std::size_t i = 0; !beyond && i < settings_.lower_rad.size(); ++i)
      beyond = step.target_rad[i] < settings_.lower_rad[i] - limit_slack_rad ||
               step.target_rad[i] > settings_.upper_rad[i] + limit_slack_rad;
    if (beyond) {
      flags_.protective_stop = true;
      program_.clear();
      step_ = 0;
      break;
    }
    for (std::size_t i = 0; i < rest_rad_.size(); ++i)
      if (const double turn = step.target_rad[i] - rest_rad_[i]; std::abs(turn) > 1e-9)
        approach_[i] = turn > 0 ? 1 : -1;
    leg_ =
        Leg{rest_rad_, step.target_rad, t, {longest_turn(rest_rad_, step.target_rad), step.speed, step.acceleration}};
    if (faults_.strikes(Fault::protective_stop))
      stop_at_s_ = t + faults_.share(Fault::protective_stop) * leg_->profile.duration();
  }
  if (step_ >= program_.size() && !leg_) program_.clear(), step_ = 0;
  flags_.program_running = !program_.empty();
}

void TrueArm::advance(double t) {
  for (;;) {
    if (stop_at_s_ >= 0 && leg_ && stop_at_s_ <= t) {
      flags_.protective_stop = true;
      halt(stop_at_s_);
      continue;
    }
    if (!leg_ || leg_->end_s() > t) return;
    const double ended = leg_->end_s();
    rest_rad_ = leg_->to;
    leg_.reset();
    stop_at_s_ = -1;
    next_step(ended);
    if (!leg_) return;
  }
}

ArmSnapshot TrueArm::now() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double t = clock_.now_s();
  advance(t);
  ArmSnapshot snapshot = flags_;
  snapshot.time_s = t;
  snapshot.joints_rad = joints_at(t);
  snapshot.speed_rad_per_s = speeds_at(t);
  if (settings_.tool_pose) snapshot.tool = settings_.tool_pose(snapshot.joints_rad);
  if (settings_.encoder_noise_rad > 0)
    for (double& angle : snapshot.joints_rad) angle += settings_.encoder_noise_rad * noise_.normal();
  snapshot.approach = approach_;
  snapshot.temperature_C.assign(rest_rad_.size(), room_K - 273.15 + warmth_K(t));
  return snapshot;
}

void TrueArm::run(const std::vector<ArmStep>& program) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double t = clock_.now_s();
  advance(t);
  if (!flags_.powered || flags_.protective_stop || flags_.emergency_stop || !flags_.remote_control) return;
  ++programs_;
  program_ = program;
  step_ = 0;
  stop_at_s_ = -1;
  double acceleration = hard_stop_rad_per_s2;
  for (const ArmStep& step : program)
    if (step.kind == ArmStep::Kind::brake) acceleration = step.acceleration;
  // What comes before the first motion is done at once, while the arm still brakes.
  for (; step_ < program_.size(); ++step_) {
    const ArmStep& step = program_[step_];
    std::int32_t& held = flags_.output_registers.at(static_cast<std::size_t>(step.output_register));
    if (step.kind == ArmStep::Kind::mark)
      held = step.value;
    else if (step.kind == ArmStep::Kind::only_if && held != step.value)
      program_.clear(), step_ = 0;
    else if (step.kind != ArmStep::Kind::only_if)
      break;
    if (program_.empty()) break;
  }
  brake(t, acceleration);
  flags_.program_running = !program_.empty();
  if (!leg_) next_step(t);
}

double TrueArm::time_left_s() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double t = clock_.now_s();
  advance(t);
  return leg_ ? std::max(0.0, leg_->end_s() - t) : 0;
}

void TrueArm::halt(double t) {
  program_.clear();
  step_ = 0;
  flags_.program_running = false;
  stop_at_s_ = -1;
  brake(t, hard_stop_rad_per_s2);
}

void TrueArm::protective_stop() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double t = clock_.now_s();
  advance(t);
  flags_.protective_stop = true;
  halt(t);
}

void TrueArm::emergency_stop() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double t = clock_.now_s();
  advance(t);
  flags_.emergency_stop = true;
  halt(t);
}

void TrueArm::end_program() {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double t = clock_.now_s();
  advance(t);
  halt(t);
}

void TrueArm::clear_stops() {
  const std::lock_guard<std::mutex> lock(mutex_);
  advance(clock_.now_s());
  flags_.protective_stop = flags_.emergency_stop = false;
}

void TrueArm::set_powered(bool powered) {
  const std::lock_guard<std::mutex> lock(mutex_);
  flags_.powered = powered;
}

void TrueArm::set_remote_control(bool remote) {
  const std::lock_guard<std::mutex> lock(mutex_);
  flags_.remote_control = remote;
}

std::int64_t TrueArm::programs() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return programs_;
}

}  // namespace gonio::acquisition::desk
