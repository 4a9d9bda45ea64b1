#include "light/aimed.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "light/warp.h"

namespace gonio::light {
namespace {

class CosineLobe final : public Lobe {
 public:
  explicit CosineLobe(double exponent) : exponent_(exponent) {}
  double relative(Vec3 local) const override { return local.z > 0 ? std::pow(local.z, exponent_) : 0; }
  Draw draw(Vec2 u) const override {
    const Vec3 local = on_lobe(u, exponent_);
    return {local, (exponent_ + 1) / (2 * pi) * relative(local)};
  }

 private:
  double exponent_;
};

class AimedPoint final : public Emitter {
 public:
  AimedPoint(Vec3 position_m, const Basis& frame, Rgb watt_per_sr, std::shared_ptr<const Lobe> lobe)
      : position_m_(position_m), frame_(frame), watt_per_sr_(watt_per_sr), lobe_(std::move(lobe)) {}
  Sample sample(Vec3 point_m, Vec2) const override {
    const Vec3 arm = position_m_ - point_m;
    const double square = dot(arm, arm);
    if (!(square > 0)) return {};
    const double distance = std::sqrt(square), relative = lobe_->relative(frame_.to_local(-arm / distance));
    if (!(relative > 0)) return {};
    return {arm / distance, distance, watt_per_sr_ * (relative / square), 0, true, true};
  }
  Hit hit(Vec3, Vec3) const override { return {}; }
  Emission emit(Vec2, Vec2 u_direction) const override {
    const Lobe::Draw drawn = lobe_->draw(u_direction);
    if (!(drawn.pdf > 0)) return {};
    return {position_m_, frame_.to_world(drawn.local), watt_per_sr_ * (lobe_->relative(drawn.local) / drawn.pdf), true};
  }

 private:
  Vec3 position_m_;
  Basis frame_;
  Rgb watt_per_sr_;
  std::shared_ptr<const Lobe> lobe_;
};

class AimedDisc final : public Emitter {
 public:
  AimedDisc(Vec3 centre_m, const Basis& frame, Rgb watt_per_sr, double radius_m, std::shared_ptr<const Lobe> lobe)
      : centre_m_(centre_m),
        frame_(frame),
        watt_per_sr_(watt_per_sr),
        radius_m_(radius_m),
        area_m2_(pi * radius_m * radius_m),
        lobe_(std::move(lobe)) {}

  Sample sample(Vec3 point_m, Vec2 u) const override {
    const Vec3 arm = on_surface(u) - point_m;
    const double square = dot(arm, arm), distance = std::sqrt(square), cosine = -dot(arm, frame_.n) / distance;
    if (!(cosine > least_cosine)) return {};
    const double relative = lobe_->relative(frame_.to_local(-arm / distance));
    return {arm / distance, distance, watt_per_sr_ * (relative / square), square / (area_m2_ * cosine), false, true};
  }

  Hit hit(Vec3 origin_m, Vec3 direction) const override {
    const double cosine = -dot(direction, frame_.n);
    if (!(cosine > least_cosine)) return {};
    const double distance = dot(origin_m - centre_m_, frame_.n) / cosine;
    const Vec3 across = origin_m + direction * distance - centre_m_;
    if (!(distance > 0) || dot(across, across) > radius_m_ * radius_m_) return {};
    const double relative = lobe_->relative(frame_.to_local(-direction));
    return {distance, watt_per_sr_ * (relative / (area_m2_ * cosine)), distance * distance / (area_m2_ * cosine)};
  }

  Emission emit(Vec2 u_position, Vec2 u_direction) const override {
    const Lobe::Draw drawn = lobe_->draw(u_direction);
    if (!(drawn.pdf > 0)) return {};
    return {on_surface(u_position), frame_.to_world(drawn.local),
            watt_per_sr_ * (lobe_->relative(drawn.local) / drawn.pdf), true};
  }

 private:
  static constexpr double least_cosine = 1e-9;  // directions nearer to the disc's plane miss it
  Vec3 on_surface(Vec2 u) const {
    const Vec2 at = on_disc(u) * radius_m_;
    return centre_m_ + frame_.t * at.x + frame_.b * at.y;
  }

  Vec3 centre_m_;
  Basis frame_;
  Rgb watt_per_sr_;
  double radius_m_, area_m2_;
  std::shared_ptr<const Lobe> lobe_;
};

}  // namespace

Basis lamp_frame(Vec3 direction, Vec3 up, const std::string& place) {
  const double length = norm(direction);
  if (!(length > 1e-9 && std::isfinite(length)))
    throw Error(Exit::data, place + "/direction", "direction has no length", "give the direction of the lamp's axis");
  const Vec3 n = direction / length;
  const bool given = norm(up) > 0;
  if (!given) up = std::abs(n.z) < 0.999 ? Vec3{0, 0, 1} : Vec3{0, 1, 0};
  const Vec3 across = cross(up / norm(up), n);
  if (!(norm(across) > 1e-6))
    throw Error(Exit::data, place + "/up", "up lies along the lamp's direction", "give another direction");
  const Vec3 x = normalized(across);
  return Basis(n, x);
}

std::unique_ptr<const Lobe> cosine_lobe(double exponent) {
  return std::make_unique<CosineLobe>(exponent);
}

std::unique_ptr<Emitter> aimed_lamp(Vec3 position_m, const Basis& frame, Rgb watt_per_sr, double radius_m,
                                    std::shared_ptr<const Lobe> lobe) {
  if (radius_m > 0) return std::make_unique<AimedDisc>(position_m, frame, watt_per_sr, radius_m, std::move(lobe));
  return std::make_unique<AimedPoint>(position_m, frame, watt_per_sr, std::move(lobe));
}

manifest::ParameterInfo position_info(const char* meaning) {
  return {.name = "position_m", .unit = "m", .components = 3, .preset = {}, .meaning = meaning};
}
manifest::ParameterInfo direction_info() {
  return {.name = "direction",
          .unit = "1",
          .components = 3,
          .preset = {},
          .meaning = "axis of the lamp, away from it, in the world frame; its length does not matter"};
}
manifest::ParameterInfo up_info() {
  return {
      .name = "up",
      .unit = "1",
      .components = 3,
      .preset = 0,
      .meaning = "which way is up on the lamp, in the world frame; [0, 0, 0]: +z, or +y for lamps that shine along z"};
}
manifest::ParameterInfo intensity_info(const char* meaning) {
  return {.name = "watt_per_sr",
          .unit = "W/sr",
          .components = 3,
          .rgb = true,
          .preset = {},
          .lower = 0,
          .meaning = meaning};
}
manifest::ParameterInfo exponent_info(double preset) {
  return {.name = "exponent",
          .unit = "1",
          .preset = preset,
          .lower = 0,
          .upper = 200,
          .meaning = "intensity falls as cos^exponent of the emission angle; 1: the same radiance in all directions"};
}

}  // namespace gonio::light
