// light.polarization: a lamp with a polarizing sheet in front. Its axis x is that of the frame carried along from +z to
// the direction from the scene's centre to the lamp (geom/vector.h: Basis); light that travels along d is polarized
// along x made perpendicular to d, or by 45 degrees from it, by the stated degrees. Radiance stays.
#pragma once
#include <algorithm>
#include <cmath>
#include <memory>

#include "light/light.h"

namespace gonio::light {

struct Sheet {
  Vec3 x;  // unit, world frame
  double degree_0 = 0, degree_45 = 0;

  // `towards`: unit, from the scene's centre to the lamp.
  static Sheet before(Vec3 towards, double degree_0, double degree_45) {
    const double all = std::max(1.0, std::hypot(degree_0, degree_45));  // no more than all of it is polarized
    return {Basis(towards).t, degree_0 / all, degree_45 / all};
  }
  Polarization of(Vec3 travel) const {
    const Vec3 across = x - travel * dot(travel, x);
    const double length = norm(across);
    return {length > 1e-9 ? across / length : Basis(travel).t, {{1, degree_0, degree_45, 0}}};
  }
};

class PolarizedEmitter final : public Emitter {
 public:
  PolarizedEmitter(std::shared_ptr<const Emitter> lamp, const Sheet& sheet) : lamp_(std::move(lamp)), sheet_(sheet) {}
  const std::shared_ptr<const Emitter>& bare() const { return lamp_; }
  const Sheet& sheet() const { return sheet_; }
  Sample sample(Vec3 point_m, Vec2 u) const override { return lamp_->sample(point_m, u); }
  Hit hit(Vec3 origin_m, Vec3 direction) const override { return lamp_->hit(origin_m, direction); }
  bool infinite() const override { return lamp_->infinite(); }
  Emission emit(Vec2 u_position, Vec2 u_direction) const override { return lamp_->emit(u_position, u_direction); }
  std::optional<Polarization> polarization(Vec3 travel) const override { return sheet_.of(travel); }

 private:
  std::shared_ptr<const Emitter> lamp_;
  Sheet sheet_;
};

}  // namespace gonio::light
