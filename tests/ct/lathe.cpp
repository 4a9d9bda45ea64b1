// A polygon of (r, z) turned round the z axis. A side (r0, z0)-(r1, z1) sweeps a piece of a cone, x^2 + y^2 = (a + b
// z)^2 over lower <= z < upper, so that a ray crosses the ring between two sides once; a level side sweeps a flat ring.
#include <algorithm>
#include <cmath>

#include "ct/shape.h"

namespace gonio::ct {
namespace {

struct Side {
  Vec2 from, to;
  double low, high;  // z
  double a, b;       // radius = a + b z; not of level sides
  bool level;
};

class Lathe final : public Shape {
 public:
  Lathe(Vec3 base, std::vector<Vec2> profile) : base_(base), profile_(std::move(profile)) {
    if (profile_.size() < 3) throw std::invalid_argument("a profile has three corners or more");
    double low = profile_[0].y, high = low;
    for (const Vec2& p : profile_) {
      if (p.x < 0) throw std::invalid_argument("a profile lies at r >= 0");
      low = std::min(low, p.y), high = std::max(high, p.y), widest_ = std::max(widest_, p.x);
    }
    middle_ = (low + high) / 2, half_ = (high - low) / 2;
    for (std::size_t k = 0; k < profile_.size(); ++k) {
      const Vec2 p = profile_[k], q = profile_[(k + 1) % profile_.size()];
      if (p == q || (p.x == 0 && q.x == 0)) continue;
      Side s{p, q, std::min(p.y, q.y), std::max(p.y, q.y), 0, 0, p.y == q.y};
      if (!s.level) s.b = (q.x - p.x) / (q.y - p.y), s.a = p.x - s.b * p.y;
      sides_.push_back(s);
    }
  }

  void cut(const Ray& ray, Spans& into) const override {
    Ray local{ray.origin - base_, ray.direction};
    // Only sides at heights that the ray has within the ball round everything.
    const double along = -dot(local.origin - Vec3{0, 0, middle_}, local.direction);
    const double reach = std::hypot(widest_, half_) * (1 + 1e-6), rise = std::abs(local.direction.z) * reach;
    const double height = local.origin.z + along * local.direction.z;
    Crossings found;
    for (int attempt = 0; attempt < 4; ++attempt) {
      found.count = 0;
      for (const Side& side : sides_)
        if (side.high >= height - rise && side.low <= height + rise) cross(side, local, found);
      if (found.count % 2 == 0) break;
      // Through a ring or the tip, where rounding decides: a hair beside it.
      local.origin += Vec3{0.7, 0.3, 0.5} * (1e-9 * (widest_ + half_));
    }
    std::sort(found.t.begin(), found.t.begin() + static_cast<long>(found.count));
    for (std::size_t k = 0; k + 1 < found.count; k += 2) into.add(found.t[k], found.t[k + 1]);
  }

  double distance(Vec3 p) const override {
    const Vec3 q = p - base_;
    const Vec2 at{std::hypot(q.x, q.y), q.z};
    double nearest = HUGE_VAL;
    for (const Side& s : sides_) {
      const Vec2 along = s.to - s.from;
      const double t = std::clamp(dot(at - s.from, along) / dot(along, along), 0.0, 1.0);
      nearest = std::min(nearest, norm(at - s.from - along * t));
    }
    bool inside = false;  // crossings of the line from `at` to greater r
    for (const Side& s : sides_)
      if (!s.level && at.y >= s.low && at.y < s.high && at.x < s.a + s.b * at.y) inside = !inside;
    return inside ? -nearest : nearest;
  }
  Ball bound() const override { return {base_ + Vec3{0, 0, middle_}, std::hypot(widest_, half_)}; }

 private:
  struct Crossings {
    std::array<double, 2 * Spans::most> t;
    std::size_t count = 0;
    void add(double value) {
      if (count == t.size()) throw std::length_error("a ray meets a lathe more often than simulated");
      t[count++] = value;
    }
  };

  static void cross(const Side& s, const Ray& ray, Crossings& found) {
    const Vec3 o = ray.origin, d = ray.direction;
    if (d.z == 0 && !(o.z >= s.low && o.z < s.high)) return;
    if (s.level) {
      if (d.z == 0) return;
      const double t = (s.low - o.z) / d.z, r = std::hypot(o.x + t * d.x, o.y + t * d.y);
      if (r >= std::min(s.from.x, s.to.x) && r < std::max(s.from.x, s.to.x)) found.add(t);
      return;
    }
    const double at = s.a + s.b * o.z, slope = s.b * d.z;  // radius along the ray
    const double a = d.x * d.x + d.y * d.y - slope * slope, b = o.x * d.x + o.y * d.y - at * slope;
    const double c = o.x * o.x + o.y * o.y - at * at;
    const auto take = [&](double t) {
      const double z = o.z + t * d.z;
      if (z >= s.low && z < s.high && at + slope * t >= 0) found.add(t);
    };
    if (std::abs(a) < 1e-14) {
      if (b != 0) take(-c / (2 * b));
      return;
    }
    const double root = b * b - a * c;
    if (!(root > 0)) return;
    const double q = -b - std::copysign(std::sqrt(root), b);  // without cancellation
    take(q / a);
    if (q != 0) take(c / q);
  }

  Vec3 base_;
  std::vector<Vec2> profile_;
  std::vector<Side> sides_;
  double widest_ = 0, middle_ = 0, half_ = 0;
};

}  // namespace

ShapePtr lathe(Vec3 base, std::vector<Vec2> profile) {
  return std::make_shared<Lathe>(base, std::move(profile));
}

}  // namespace gonio::ct
