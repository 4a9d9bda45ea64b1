// Lamps and a turntable of a simulated laboratory as they truly are. Threads may ask at once.
#pragma once
#include <map>
#include <mutex>

#include "acquisition/desk/desk_clock.h"
#include "acquisition/desk/trapezoid.h"

namespace gonio::acquisition::desk {

class TrueLamps {
 public:
  void set(int lamp, bool lit) {
    const std::lock_guard<std::mutex> lock(mutex_);
    lit_[lamp] = lit;
  }
  bool lit(int lamp) const {
    const std::lock_guard<std::mutex> lock(mutex_);
    const auto at = lit_.find(lamp);
    return at != lit_.end() && at->second;
  }

 private:
  mutable std::mutex mutex_;
  std::map<int, bool> lit_;
};

// Turns from rest to rest towards its target; stops where it is told another one.
class TrueTurntable {
 public:
  TrueTurntable(const DeskClock& clock, double speed_rad_per_s, double acceleration_rad_per_s2)
      : clock_(clock), speed_(speed_rad_per_s), acceleration_(acceleration_rad_per_s2) {}
  double angle_rad() const;
  double target_rad() const;
  void turn_to(double angle_rad);
  double time_left_s() const;

 private:
  double reached(double now_s) const;
  const DeskClock& clock_;
  mutable std::mutex mutex_;
  double speed_, acceleration_, from_ = 0, target_ = 0, since_s_ = 0;
};

}  // namespace gonio::acquisition::desk
