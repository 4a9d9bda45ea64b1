// A motion from rest to rest: acceleration a, cruising speed v, deceleration a (Spong, Hutchinson & Vidyasagar 2006,
// section 5.5.2).
#pragma once
#include <algorithm>

#include "acquisition/motion/way.h"

namespace gonio::acquisition::desk {

// Distance gone after `t` seconds on a way of length `distance`, and the speed then.
struct Trapezoid {
  double distance = 0, speed = 1, acceleration = 1;
  double duration() const { return trapezoid_time(distance, speed, acceleration); }
  double gone(double t) const {
    const double whole = duration(), ramp = std::min(speed / acceleration, whole / 2);
    if (t <= 0) return 0;
    if (t >= whole) return distance;
    if (t < ramp) return acceleration * t * t / 2;
    if (t > whole - ramp) return distance - acceleration * (whole - t) * (whole - t) / 2;
    return acceleration * ramp * ramp / 2 + acceleration * ramp * (t - ramp);
  }
  double speed_at(double t) const {
    const double whole = duration(), ramp = std::min(speed / acceleration, whole / 2);
    return t <= 0 || t >= whole ? 0 : acceleration * std::min({t, whole - t, ramp});
  }
};

}  // namespace gonio::acquisition::desk
