#include "acquisition/device/ur_robot.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <mutex>
#include <numbers>
#include <random>

#include "acquisition/device/connection.h"
#include "acquisition/device/modbus_client.h"
#include "acquisition/device/register_map.h"
#include "acquisition/device/rtde_client.h"
#include "acquisition/device/urscript.h"
#include "base/error.h"
#include "base/text.h"

namespace gonio::acquisition {
namespace {

constexpr double arrived_rad = 1e-4;         // devices.h
constexpr double at_beginning_rad = 1e-3;    // devices.h
constexpr double standing_rad_per_s = 2e-3;  // encoders' noise in actual_qd stays below
constexpr double register_slack_rad = 2e-3;  // registers hold mrad, cut or rounded, a little older than the packet
constexpr double stop_rad_per_s2 = 2;        // of the leading axis, as `stopj` of the manual's examples

// RTDE guide: "Robot Mode", "Safety Mode".
const char* robot_mode_word(int mode) {
  static constexpr const char* mode_words[] = {"DISCONNECTED", "CONFIRM_SAFETY", "BOOTING",
                                               "POWER_OFF",    "POWER_ON",       "IDLE",
                                               "BACKDRIVE",    "RUNNING",        "UPDATING_FIRMWARE"};
  return mode == -1 ? "NO_CONTROLLER" : mode >= 0 && mode <= 8 ? mode_words[mode] : "UNKNOWN_MODE";
}
const char* safety_mode_word(int mode) {
  static constexpr const char* mode_words[] = {"NORMAL",
                                               "REDUCED",
                                               "PROTECTIVE_STOP",
                                               "RECOVERY",
                                               "SAFEGUARD_STOP",
                                               "SYSTEM_EMERGENCY_STOP",
                                               "ROBOT_EMERGENCY_STOP",
                                               "VIOLATION",
                                               "FAULT"};
  return mode >= 1 && mode <= 9 ? mode_words[mode - 1] : "UNDEFINED_SAFETY_MODE";
}
constexpr int mode_running = 7;                                              // robot mode
constexpr std::uint32_t bit_power_on = 1u << 0, bit_program_runs = 1u << 1;  // robot_status_bits
constexpr std::uint32_t bit_protective = 1u << 2, bit_safeguard = 1u << 4;   // safety_status_bits
constexpr std::uint32_t bits_emergency = 1u << 5 | 1u << 6 | 1u << 7, bits_fault = 1u << 8 | 1u << 9;
constexpr std::uint32_t bit_stopped_for_safety = 1u << 10;

bool ur_stands(const RtdeState& state) {
  return std::all_of(state.speed_rad_per_s.begin(), state.speed_rad_per_s.end(),
                     [](double speed) { return std::abs(speed) <= standing_rad_per_s; });
}

// What keeps the arm from moving, in the controller's words; empty: nothing.
std::string ur_obstacle(const RtdeState& state) {
  if (state.robot_mode != mode_running) return std::string("robot mode ") + robot_mode_word(state.robot_mode);
  if ((state.safety_bits & (bit_protective | bit_safeguard | bits_emergency | bits_fault | bit_stopped_for_safety)) !=
          0 ||
      state.safety_mode > 2 || state.safety_mode < 1)
    return std::string("safety mode ") + safety_mode_word(state.safety_mode);
  return {};
}

// The joint that is farthest from `wanted`, in words; empty where all are within `limit_rad`.
std::string farthest_joint(std::span<const double> joints, std::span<const double> wanted, double limit_rad) {
  std::size_t worst = 0;
  double error = 0;
  for (std::size_t i = 0; i < wanted.size(); ++i)
    if (const double e = std::abs(joints[i] - wanted[i]); !(e <= error)) worst = i, error = e;
  if (error <= limit_rad) return {};
  return format("joint %d stands at %.6f rad instead of %.6f (limit %g)", static_cast<int>(worst + 1), joints[worst],
                wanted[worst], limit_rad);
}

class UrRobot : public RobotDevice {
 public:
  UrRobot(const UrAddress& address, const std::string& place)
      : address_(address), place_(place), rtde_(rtde_address(), place) {
    if (address.modbus_port)
      registers_ = std::make_unique<ModbusClient>(
          ModbusAddress{address.host, *address.modbus_port, address.modbus_unit, address.timeout_s, 3}, place);
    // Where this program's numbers begin says nothing of others': they are told apart by being unlikely.
    number_ = static_cast<int>(std::random_device{}() & 0x0FFFFFFF) + 1;
  }

  RobotState state() override {
    const std::lock_guard<std::mutex> lock(one_at_a_time_);
    return whole_state(rtde_.fresh());
  }

  RobotState move(std::span<const std::vector<double>> way, std::span<const double> speeds,
                  std::span<const double> accelerations) override {
    const std::lock_guard<std::mutex> lock(one_at_a_time_);
    check_request(way, speeds, accelerations);
    const int stops_before = stops_;
    const RtdeState before = rtde_.fresh();
    check_ready(before, way[0]);
    const ProgramMark mark = next_mark(before.program);
    try {
      Connection line = script_line();
      send_script(line, motion_script(mark, way, speeds, accelerations));
      const RobotState end = whole_state(watch(line, mark, way.back(), stops_before));
      if (const auto astray = farthest_joint(end.joints_rad, way.back(), arrived_rad); !astray.empty())
        throw unavailable("left the end of its way: " + astray, "see what pushes it");
      return end;
    } catch (const Error& error) {
      if (stops_ != stops_before || halted()) throw;
      throw Error(error.code(), error.place(), error.problem() + "; and it did not take the program that stops it",
                  "press the emergency stop");
    } catch (...) {
      halted();
      throw;
    }
  }

  void stop() override {  // may be called while move() waits: connections of its own
    ++stops_;
    halt();
  }

 private:
  RtdeAddress rtde_address() const {
    return {address_.host, address_.rtde_port, address_.program_register, address_.timeout_s, 125};
  }
  Error unavailable(const std::string& problem, const std::string& remedy) const {
    return Error(Exit::unavailable, place_, "robot at " + address_.host + ": " + problem, remedy);
  }

  ProgramMark next_mark(int seen) {
    ProgramMark mark{number_++, address_.program_register, seen};
    if (mark.begun() == (seen & ~1)) mark.number = number_++;
    return mark;
  }

  void check_request(std::span<const std::vector<double>> way, std::span<const double> speeds,
                     std::span<const double> accelerations) const {
    const auto wrong = [&](const std::string& problem) {
      throw Error(Exit::internal, place_, "motion asked of robot at " + address_.host + ": " + problem);
    };
    if (way.empty()) wrong("a way without points");
    if (speeds.size() != 6 || accelerations.size() != 6) wrong("speeds and accelerations of six joints are needed");
    for (const auto& point : way) {
      if (point.size() != 6) wrong("a point without six joints");
      for (const double angle : point)
        if (!(std::abs(angle) <= 2 * std::numbers::pi + 1e-9)) wrong("an angle beyond one turn to either side");
    }
    for (std::size_t i = 0; i < 6; ++i)
      if (!(speeds[i] > 0 && speeds[i] < 100 && accelerations[i] > 0 && accelerations[i] < 1000))
        wrong("a speed or an acceleration that is none");
  }

  void check_ready(const RtdeState& state, const std::vector<double>& first) {
    if (const auto obstacle = ur_obstacle(state); !obstacle.empty())
      throw unavailable("cannot move: " + obstacle, "clear it at the pendant");
    if ((state.robot_bits & bit_program_runs) != 0)
      throw unavailable("another program runs on it", "end that one at the pendant");
    if (!ur_stands(state)) throw unavailable("moves although no program of ours runs", "wait until it stands");
    if (const auto astray = farthest_joint(state.joints_rad, first, at_beginning_rad); !astray.empty())
      throw unavailable("is not where the way begins: " + astray, "read its state and plan from there");
    if (!remote_control())
      throw unavailable("is not in remote control", "switch it at the pendant: Local -> Remote Control");
  }

  // Dashboard server (e-Series: "is in remote control" -> true | false). CB3 has no such mode, and says that it does
  // not understand.
  bool remote_control() {
    if (!address_.dashboard_port) return true;
    std::string problem;
    for (int attempt = 0; attempt < 3; ++attempt) {
      try {
        Connection line(address_.host, *address_.dashboard_port, address_.timeout_s,
                        "dashboard at " + address_.host + ":" + std::to_string(*address_.dashboard_port));
        const auto until = after(address_.timeout_s);
        line.line(500, until);  // its greeting
        line.send("is in remote control\n", until);
        const std::string answer = line.line(500, until);
        if (answer == "true" || answer == "false") return answer == "true";
        if (answer.rfind("could not understand", 0) == 0) return true;
        problem = line.what() + " answered '" + answer + "'";
      } catch (const Lost& lost) {
        problem = lost.what();
      }
    }
    throw unavailable(problem, "enable its dashboard server, or write dashboard=none where it has none (PolyScope X)");
  }

  Connection script_line() const {
    try {
      return Connection(address_.host, address_.script_port, address_.timeout_s,
                        "secondary interface at " + address_.host + ":" + std::to_string(address_.script_port));
    } catch (const Lost& lost) {
      throw unavailable(lost.what(), "check that the network leads there and the interface is enabled");
    }
  }
  void send_script(Connection& line, const std::string& text) const {
    try {
      line.send(text, after(address_.timeout_s));
    } catch (const Lost& lost) {
      throw unavailable(std::string(lost.what()) + " while a program was sent", "try again");
    }
  }
  // Returns when it stands: true where the controller took the program that stops it, so that none sent before will
  // begin; false where it did not, as in local control, and no program runs.
  bool halt() {
    const ProgramMark mark = next_mark(0);
    Connection line;
    std::string unsent;
    for (int attempt = 0; attempt < 3 && !line.is_open(); ++attempt) {
      try {
        line = script_line();
        send_script(line, stop_script(mark, stop_rad_per_s2));
      } catch (const Error& error) {
        unsent = error.problem();
        line.close();
      }
    }
    const auto until = after(line.is_open() ? address_.begin_s : 0);
    bool taken = false;
    RtdeClient rtde(rtde_address(), place_);
    rtde.follow([&](const RtdeState& now, bool) {
      line.discard();
      taken = now.program == mark.ended() || !ur_obstacle(now).empty();
      return stopped(now, mark, taken, until, unsent);
    });
    return taken;
  }
  bool halted() noexcept {
    try {
      return halt();
    } catch (...) {
      return false;
    }
  }

  bool stopped(const RtdeState& now, const ProgramMark& mark, bool taken, Clock::time_point until,
               const std::string& unsent) const;
  RtdeState watch(Connection& line, const ProgramMark& mark, const std::vector<double>& target, int stops_before);
  void judge_running(const RtdeState& now, const ProgramMark& mark, const std::vector<double>& target) const;
  RobotState whole_state(const RtdeState& first);
  std::string registers_disagree(const RtdeState& seen);

  UrAddress address_;
  std::string place_;
  RtdeClient rtde_;
  std::unique_ptr<ModbusClient> registers_;
  std::mutex one_at_a_time_;
  std::atomic<int> number_{1}, stops_{0};
};

bool UrRobot::stopped(const RtdeState& now, const ProgramMark& mark, bool taken, Clock::time_point until,
                      const std::string& unsent) const {
  if (taken && ur_stands(now)) return true;
  if (Clock::now() < until || (now.program == mark.begun() && !ur_stands(now))) return false;
  if (ur_stands(now) && (now.robot_bits & bit_program_runs) == 0) return true;
  throw unavailable("cannot be stopped: " + (unsent.empty() ? "it did not take the program that stops it" : unsent),
                    "press the emergency stop");
}

// Throws where this state says that the program will not arrive.
void UrRobot::judge_running(const RtdeState& now, const ProgramMark& mark, const std::vector<double>& target) const {
  const auto where = [&] {
    const auto astray = farthest_joint(now.joints_rad, target, arrived_rad);
    return astray.empty() ? std::string("it stands at the end of its way") : astray;
  };
  if (const auto obstacle = ur_obstacle(now); !obstacle.empty())
    throw unavailable("stopped on its way: " + obstacle + "; " + where(), "clear it at the pendant, then resume");
  if (now.program != mark.begun() && now.program != mark.ended())
    throw unavailable("another program took the place of ours; " + where(), "let one program command the arm");
}

RtdeState UrRobot::watch(Connection& line, const ProgramMark& mark, const std::vector<double>& target,
                         int stops_before) {
  const auto sent = Clock::now();
  auto moved = sent;
  double sent_time_s = -1, moved_time_s = 0;
  bool begun = false;
  int arrived = 0, idle = 0;
  RtdeState last;
  rtde_.follow([&](const RtdeState& now, bool reopened) {
    line.discard();
    last = now;
    if (stops_ != stops_before) throw unavailable("was stopped on request", {});
    if (reopened || sent_time_s < 0) sent_time_s = moved_time_s = now.time_s, arrived = idle = 0;
    if (!begun && (now.program & ~1) != mark.begun()) {
      if (now.program != mark.before) judge_running(now, mark, target);
      if (const auto obstacle = ur_obstacle(now); !obstacle.empty())
        throw unavailable("cannot move: " + obstacle, "clear it at the pendant");
      if (Clock::now() > sent + std::chrono::duration<double>(address_.begin_s))
        throw unavailable(format("did not begin its program within %g s", address_.begin_s),
                          "check that it is in remote control and takes programs on its secondary interface");
      return false;
    }
    begun = true;
    judge_running(now, mark, target);
    const bool stands = ur_stands(now), runs = (now.robot_bits & bit_program_runs) != 0;
    if (!stands) moved = Clock::now(), moved_time_s = now.time_s;
    const bool there = farthest_joint(now.joints_rad, target, arrived_rad).empty();
    arrived = now.program == mark.ended() && !runs && stands && there ? arrived + 1 : 0;
    if (arrived >= 2) return true;
    idle = stands && !runs ? idle + 1 : 0;
    // Both clocks: the controller's, which may run faster than ours, and ours, in which packets may be late.
    const bool stalled = Clock::now() > moved + std::chrono::duration<double>(address_.stall_s) &&
                         now.time_s > moved_time_s + address_.stall_s;
    const bool over = idle >= 2 && now.time_s > moved_time_s + 0.5 &&
                      Clock::now() > moved + std::chrono::duration<double>(std::min(0.5, address_.stall_s));
    if (over || stalled)
      throw unavailable((runs ? "does not move although its program runs: " : "its program ended on the way: ") +
                            farthest_joint(now.joints_rad, target, 0),
                        "look at the pendant's log");
    return false;
  });
  return last;
}

// The registers hold mrad, magnitude and turn (register_map.h). Empty: they say the same.
std::string UrRobot::registers_disagree(const RtdeState& seen) {
  const RegisterReading reading = read_registers(*registers_, ur_register_map());
  for (std::size_t i = 0; i < 6; ++i)
    if (std::abs(reading.joints_rad.at(i) - seen.joints_rad[i]) > register_slack_rad)
      return format("its registers say %.4f rad of joint %d, RTDE %.4f (limit %g)", reading.joints_rad[i],
                    static_cast<int>(i + 1), seen.joints_rad[i], register_slack_rad);
  if (reading.protective_stop.value_or(false) != ((seen.safety_bits & bit_protective) != 0))
    return "its registers and RTDE disagree on a protective stop";
  return {};
}

RobotState UrRobot::whole_state(const RtdeState& first) {
  RtdeState seen = first;
  // It may have begun to move, or was stopped, between the two answers: both are asked again.
  for (int tries = 3; registers_ && ur_stands(seen);) {
    const std::string why = registers_disagree(seen);
    if (why.empty()) break;
    if (--tries == 0)
      throw unavailable(why, "is this the right host? Or write check=no where its registers are at fault");
    seen = rtde_.fresh();
  }
  RobotState state;
  state.time_s = seen.time_s;
  state.joints_rad.assign(seen.joints_rad.begin(), seen.joints_rad.end());
  state.speed_rad_per_s.assign(seen.speed_rad_per_s.begin(), seen.speed_rad_per_s.end());
  for (const double celsius : seen.temperature_C) state.temperature_K.push_back(celsius + 273.15);
  const auto& tool = seen.tool;
  state.base_from_tool = Rigid<frame::Base, frame::Tool>{quaternion_of_rotation_vector({tool[3], tool[4], tool[5]}),
                                                         {tool[0], tool[1], tool[2]}};
  state.powered = (seen.robot_bits & bit_power_on) != 0;
  state.standing = ur_stands(seen);
  state.protective_stop = (seen.safety_bits & (bit_protective | bit_safeguard)) != 0;
  state.emergency_stop = (seen.safety_bits & bits_emergency) != 0;
  state.remote_control = remote_control();
  state.mode = robot_mode_word(seen.robot_mode);
  if (seen.safety_mode != 1) state.mode += std::string(", ") + safety_mode_word(seen.safety_mode);
  return state;
}

}  // namespace

std::unique_ptr<RobotDevice> make_ur_robot(const UrAddress& address, const std::string& place) {
  return std::make_unique<UrRobot>(address, place);
}

}  // namespace gonio::acquisition
