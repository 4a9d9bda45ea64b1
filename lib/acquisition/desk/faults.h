// What goes wrong in the simulated laboratory, and how often: one place for all of it. Each kind has a probability per
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
  rtde_dropped,      // a data packet is not sent
  rtde_reordered,    // a data packet is sent after its successor
  rtde_short,        // a data packet lacks its last bytes, its head says so
  rtde_reset,        // the connection is reset instead of a data packet
  script_lost,       // a program arrives and is not run
  script_reset,      // the connection is reset before the program is run
  protective_stop,   // within a motion
  joint_limit,       // a target is taken for one beyond the joints' range: protective stop before the motion
  modbus_exception,  // server failure is answered
  modbus_busy,       // server busy is answered
  modbus_late,       // the answer comes after `late_s`
  modbus_dropped,    // no answer
  modbus_reset,      // the connection is reset instead of an answer
  lamp_dark,         // a lamp does not light although its coil is set
  count
};

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
