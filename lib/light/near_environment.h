// light.near-environment: what was taken for infinitely far surrounds the scene on a sphere of radius R = 1 /
// nearness_per_m about its centre, as the walls of a room do. A wall element that the centre sees along d stands at
// R d; a point p sees it along R d - p (p from the centre), and under the solid angle
//   dw' = dw R^2 cos(e) / |R d - p|^2,   cos(e) = d . (R d - p) / |R d - p|
// with the radiance that it has. Points beyond the walls see the far environment.
#pragma once
#include <cmath>
#include <memory>

#include "light/light.h"

namespace gonio::light {

struct Walls {
  Vec3 centre_m;
  double radius_m = 0;
  // Direction from the point to the element along d, and the solid angle there over that at the centre.
  struct Seen {
    Vec3 direction;
    double distance_m, solid_angle;
  };
  Seen seen(Vec3 point_m, Vec3 d) const {
    const Vec3 arm = d * radius_m - (point_m - centre_m);
    const double square = dot(arm, arm), distance_m = std::sqrt(square);
    const Vec3 direction = arm / distance_m;
    return {direction, distance_m, radius_m * radius_m * dot(d, direction) / square};
  }
  bool contain(Vec3 point_m) const { return norm(point_m - centre_m) < 0.999 * radius_m; }
};

class NearEnvironment final : public Emitter {
 public:
  NearEnvironment(std::shared_ptr<const Emitter> far, const Walls& walls) : far_(std::move(far)), walls_(walls) {}
  const std::shared_ptr<const Emitter>& bare() const { return far_; }
  const Walls& walls() const { return walls_; }

  Sample sample(Vec3 point_m, Vec2 u) const override {
    Sample s = far_->sample(walls_.centre_m, u);
    if (!s.valid || !walls_.contain(point_m)) return s;
    const Walls::Seen seen = walls_.seen(point_m, s.direction);
    s.direction = seen.direction;
    s.distance_m = seen.distance_m;
    s.weight *= seen.solid_angle;  // irradiance of a delta, radiance over density of others
    if (!s.delta) s.pdf /= seen.solid_angle;
    return s;
  }
  Hit hit(Vec3 origin_m, Vec3 direction) const override {
    if (!walls_.contain(origin_m)) return far_->hit(origin_m, direction);
    const Vec3 p = origin_m - walls_.centre_m;
    const double along = dot(p, direction);
    const double t = -along + std::sqrt(along * along + walls_.radius_m * walls_.radius_m - dot(p, p));
    const Vec3 d = normalized(p + direction * t);
    Hit hit = far_->hit(walls_.centre_m, d);
    hit.pdf /= walls_.seen(origin_m, d).solid_angle;
    return hit;
  }
  bool infinite() const override { return far_->infinite(); }
  std::optional<Polarization> polarization(Vec3 travel) const override { return far_->polarization(travel); }

 private:
  std::shared_ptr<const Emitter> far_;
  Walls walls_;
};

}  // namespace gonio::light
