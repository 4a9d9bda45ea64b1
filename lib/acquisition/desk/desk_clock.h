// The simulated laboratory's own time, one for all that stands in it. Served over the network it runs by itself, `pace`
// times as fast as ours; within one program it stands until somebody lets it pass, and nobody waits.
#pragma once
#include <chrono>
#include <cmath>
#include <mutex>
#include <thread>

namespace gonio::acquisition::desk {

class DeskClock {
 public:
  explicit DeskClock(double pace = 0) : pace_(pace), began_(std::chrono::steady_clock::now()) {}
  bool runs() const { return pace_ > 0; }
  double now_s() const {
    if (runs()) return pace_ * std::chrono::duration<double>(std::chrono::steady_clock::now() - began_).count();
    const std::lock_guard<std::mutex> lock(mutex_);
    return passed_s_;
  }
  void pass(double seconds) {
    if (runs()) return std::this_thread::sleep_for(std::chrono::duration<double>(seconds / pace_));
    const std::lock_guard<std::mutex> lock(mutex_);
    passed_s_ += seconds;
  }

 private:
  const double pace_;
  const std::chrono::steady_clock::time_point began_;
  mutable std::mutex mutex_;
  double passed_s_ = 0;
};

// How much warmer than the room's 20 degrees arms and cameras are after `time_s` with power on: 10 K, reached with a
// time constant of half an hour.
inline constexpr double room_K = 293.15;
inline double warmth_K(double time_s) {
  return 10 * (1 - std::exp(-time_s / 1800));
}

}  // namespace gonio::acquisition::desk
