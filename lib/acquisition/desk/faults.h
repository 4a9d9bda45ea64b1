// What goes wrong in the simulated laboratory, and how often: one place for all of it, command line and manual page
// included. Each kind has a probability per
// occasion (a packet, a request, a program) and a stream of seeded numbers of its own, so that the n-th occasion of a
// kind has the same fate whatever the others do. Threads may ask at once.
#pragma once
#include <array>
#include <cstdint>
#include <mutex>
#include <vector>

#include "base/random.h"

namespace gonio::acquisition::desk {

enum class Fault {
  rtde_dropped,
  rtde_reordered,
  rtde_short,
  rtde_reset,
  script_lost,
  script_reset,
  protective_stop,
  joint_limit,
  modbus_exception,
  modbus_busy,
  modbus_late,
  modbus_dropped,
  modbus_reset,
  lamp_dark,
  gige_dropped,
  frame_dropped,
  frame_reordered,
  trigger_lost,
  chunk_late,
  stuck_exposure,
  modbus_acknowledge,
  modbus_gateway,
  count
};

// By its number. The sentence says per what occasion it strikes.
struct FaultKind {
  const char *name, *sentence;
};
inline constexpr std::array<FaultKind, static_cast<std::size_t>(Fault::count)> fault_kinds{{
    {"rtde-dropped", "an arm's data packet is not sent"},
    {"rtde-reordered", "an arm's data packet is sent after its successor"},
    {"rtde-short", "an arm's data packet lacks its last bytes"},
    {"rtde-reset", "the connection is reset instead of an arm's data packet"},
    {"script-lost", "a program arrives at an arm and is not run"},
    {"script-reset", "the connection is reset before an arm's program is run"},
    {"protective-stop", "an arm stops within a motion"},
    {"joint-limit", "an arm takes a target for one beyond its joints' range, and stops"},
    {"modbus-exception", "a request is answered with a failure"},
    {"modbus-busy", "a request is answered with busy"},
    {"modbus-late", "a request is answered late"},
    {"modbus-dropped", "a request is not answered"},
    {"modbus-reset", "the connection is reset instead of an answer"},
    {"lamp-dark", "a lamp that is switched on does not light"},
    {"gige-dropped", "a camera's answer to a command is not sent"},
    {"frame-dropped", "one packet of a picture is not sent"},
    {"frame-reordered", "two packets of a picture change places"},
    {"trigger-lost", "a camera does not hear a trigger"},
    {"chunk-late", "a picture carries the figures of the one before"},
    {"stuck-exposure", "a picture is taken with the exposure of the one before"},
    {"modbus-acknowledge", "a request is answered with not yet"},
    {"modbus-gateway", "a request is answered by a gateway that reached nobody"},
}};

class Faults {
 public:
  explicit Faults(std::uint64_t seed = 1) {
    for (std::size_t i = 0; i < kinds; ++i) random_.emplace_back(seed, i);
  }
  double late_s = 0.05;
  void set(Fault kind, double probability) {
    const std::lock_guard<std::mutex> lock(mutex_);
    probability_[index(kind)] = probability;
  }
  bool strikes(Fault kind) {
    const std::lock_guard<std::mutex> lock(mutex_);
    const std::size_t i = index(kind);
    ++occasions_[i];
    const bool strikes = random_[i].uniform() < probability_[i];
    struck_[i] += strikes ? 1 : 0;
    return strikes;
  }
  double share(Fault kind) {  // a uniform number of that kind: where within a motion it strikes
    const std::lock_guard<std::mutex> lock(mutex_);
    return random_[index(kind)].uniform();
  }
  std::int64_t struck(Fault kind) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return struck_[index(kind)];
  }
  std::int64_t occasions(Fault kind) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    return occasions_[index(kind)];
  }

 private:
  static constexpr std::size_t kinds = static_cast<std::size_t>(Fault::count);
  static std::size_t index(Fault kind) { return static_cast<std::size_t>(kind); }
  mutable std::mutex mutex_;
  std::vector<Random> random_;
  std::array<double, kinds> probability_{};
  std::array<std::int64_t, kinds> occasions_{}, struck_{};
};

}  // namespace gonio::acquisition::desk
