// See true_devices.h.
#include "acquisition/desk/true_devices.h"

#include <algorithm>
#include <cmath>

namespace gonio::acquisition::desk {

double TrueTurntable::reached(double now_s) const {
  const Trapezoid way{std::abs(target_ - from_), speed_, acceleration_};
  if (now_s - since_s_ >= way.duration()) return target_;
  return from_ + std::copysign(way.gone(now_s - since_s_), target_ - from_);
}

double TrueTurntable::angle_rad() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return reached(clock_.now_s());
}

double TrueTurntable::target_rad() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return target_;
}

void TrueTurntable::turn_to(double angle_rad) {
  const std::lock_guard<std::mutex> lock(mutex_);
  const double now_s = clock_.now_s();
  from_ = reached(now_s);
  target_ = angle_rad;
  since_s_ = now_s;
}

double TrueTurntable::time_left_s() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  const Trapezoid way{std::abs(target_ - from_), speed_, acceleration_};
  return std::max(0.0, since_s_ + way.duration() - clock_.now_s());
}

}  // namespace gonio::acquisition::desk
