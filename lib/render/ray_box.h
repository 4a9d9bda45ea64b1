// A box of the world that rays are tried against before anything in it. World frame, metres.
#pragma once
#include <algorithm>

#include "geom/vector.h"
#include "render/ray_caster.h"

namespace gonio::render {

struct RayBox {
  Vec3 low{far_away, far_away, far_away}, high{-far_away, -far_away, -far_away};
  void add(Vec3 a, Vec3 b) {
    low = {std::min(low.x, a.x), std::min(low.y, a.y), std::min(low.z, a.z)};
    high = {std::max(high.x, b.x), std::max(high.y, b.y), std::max(high.z, b.z)};
  }
  bool empty() const { return !(low.x <= high.x); }
  void widen(double by_m) {
    low = low - Vec3{by_m, by_m, by_m};
    high = high + Vec3{by_m, by_m, by_m};
  }
  // Does the ray pass through, nearer than `limit_m`? Slabs (Kay & Kajiya 1986); where a ray runs along a side and
  // starts on it, 0 times infinity is no number, and that side is left out by the order of the comparisons.
  bool met_by(Vec3 origin_m, Vec3 direction, double limit_m) const {
    if (empty()) return false;
    double enter = 0, leave = limit_m;
    const auto slab = [&](double from, double along, double a, double b) {
      const double scale = 1 / along, one = (a - from) * scale, other = (b - from) * scale;
      enter = std::max(enter, std::min(one, other));
      leave = std::min(leave, std::max(one, other));
    };
    slab(origin_m.x, direction.x, low.x, high.x);
    slab(origin_m.y, direction.y, low.y, high.y);
    slab(origin_m.z, direction.z, low.z, high.z);
    return enter <= leave;
  }
};

}  // namespace gonio::render
