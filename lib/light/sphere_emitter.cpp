// Point and sphere lights. World frame, metres, W/sr.
//   point:   weight I / d^2, a delta direction
//   sphere:  L = I / (pi R^2) over the cone that the sphere fills, sin(s) = R / d; directions uniform in the cone
//            (Shirley, Wang & Zimmerman 1996, section 3.2.1): pdf = 1 / (2 pi (1 - cos(s)))
// With 1 - cos(s) = sin^2(s) / (1 + cos(s)), weight = L / pdf = 2 I / (d^2 (1 + cos(s))), which tends to the point's
// without cancellation as R goes to 0. The shell shines outwards: a point inside receives nothing from it.
//
// emit(): the power of both is 4 pi I. A photon of the point leaves in any direction alike, density 1 / (4 pi); one of
// the sphere leaves anywhere on the shell, density 1 / (4 pi R^2), cosine-distributed about the normal, density
// cos / pi: flux = L cos / (density product) = 4 pi I. Every photon carries the power itself.
#include "light/sphere_emitter.h"

#include <algorithm>
#include <cmath>

#include "light/warp.h"

namespace gonio::light {
namespace {

class Point final : public Emitter {
 public:
  Point(Vec3 position_m, Rgb watt_per_sr) : position_m_(position_m), watt_per_sr_(watt_per_sr) {}
  Sample sample(Vec3 point_m, Vec2) const override {
    const Vec3 arm = position_m_ - point_m;
    const double square = dot(arm, arm);
    if (!(square > 0)) return {};
    const double distance = std::sqrt(square);
    return {arm / distance, distance, watt_per_sr_ / square, 0, true, true};
  }
  Hit hit(Vec3, Vec3) const override { return {}; }
  Emission emit(Vec2, Vec2 u_direction) const override {
    return {position_m_, on_sphere(u_direction), watt_per_sr_ * (4 * pi), true};
  }

 private:
  Vec3 position_m_;
  Rgb watt_per_sr_;
};

class Sphere final : public Emitter {
 public:
  Sphere(Vec3 position_m, Rgb watt_per_sr, double radius_m)
      : position_m_(position_m),
        watt_per_sr_(watt_per_sr),
        radius_m_(radius_m),
        radiance_(watt_per_sr / (pi * radius_m * radius_m)) {}

  Sample sample(Vec3 point_m, Vec2 u) const override {
    const Vec3 arm = position_m_ - point_m;
    const double square = dot(arm, arm), room = square - radius_m_ * radius_m_;
    if (!(room > 0)) return {};
    const double distance = std::sqrt(square), cos_s = std::sqrt(room / square);
    const double rise = u.x * rise_of(square, cos_s);  // 1 - cosine of the drawn direction
    const double cosine = 1 - rise, sine = std::sqrt(std::max(0.0, rise * (2 - rise))), phi = 2 * pi * u.y;
    const Vec3 direction = Basis(arm / distance).to_world({sine * std::cos(phi), sine * std::sin(phi), cosine});
    // Nearer intersection with the sphere; the root is clamped where rounding leaves the drawn ray a hair outside.
    const double root = std::sqrt(std::max(0.0, radius_m_ * radius_m_ - square * sine * sine));
    return {
        direction, distance * cosine - root, watt_per_sr_ * (2 / (square * (1 + cos_s))), density(square, cos_s), false,
        true};
  }

  Hit hit(Vec3 origin_m, Vec3 direction) const override {
    const Vec3 arm = position_m_ - origin_m;
    const double square = dot(arm, arm), room = square - radius_m_ * radius_m_, along = dot(arm, direction);
    const Vec3 across = arm - direction * along;
    const double depth = radius_m_ * radius_m_ - dot(across, across);
    if (!(room > 0) || along <= 0 || depth < 0) return {};
    return {along - std::sqrt(depth), radiance_, density(square, std::sqrt(room / square))};
  }

  Emission emit(Vec2 u_position, Vec2 u_direction) const override {
    const Vec3 normal = on_sphere(u_position);
    return {position_m_ + normal * radius_m_, Basis(normal).to_world(on_lobe(u_direction, 1)), watt_per_sr_ * (4 * pi),
            true};
  }

 private:
  double rise_of(double square, double cos_s) const { return radius_m_ * radius_m_ / (square * (1 + cos_s)); }
  double density(double square, double cos_s) const { return 1 / (2 * pi * rise_of(square, cos_s)); }

  Vec3 position_m_;
  Rgb watt_per_sr_;
  double radius_m_;
  Rgb radiance_;
};

}  // namespace

std::unique_ptr<Emitter> sphere_emitter(Vec3 position_m, Rgb watt_per_sr, double radius_m) {
  if (radius_m > 0) return std::make_unique<Sphere>(position_m, watt_per_sr, radius_m);
  return std::make_unique<Point>(position_m, watt_per_sr);
}

SphereLamp::SphereLamp(std::string id, std::string sentence, std::string source, std::string position_meaning,
                       std::optional<double> radius_preset, std::string radius_meaning)
    : info_{.family = manifest::Family::light,
            .id = std::move(id),
            .sentence = std::move(sentence),
            .source = std::move(source),
            .parameters = {{.name = "position_m",
                            .unit = "m",
                            .components = 3,
                            .preset = {},
                            .meaning = std::move(position_meaning)},
                           {.name = "watt_per_sr",
                            .unit = "W/sr",
                            .components = 3,
                            .rgb = true,
                            .preset = {},
                            .lower = 0,
                            .meaning = "radiant intensity of linear red, green and blue"},
                           {.name = "radius_m",
                            .unit = "m",
                            .preset = radius_preset,
                            .lower = 0,
                            .meaning = std::move(radius_meaning)}}} {}

std::unique_ptr<Emitter> SphereLamp::prepare(const manifest::Parameters& parameters, const Attachment&,
                                             const std::string& place) const {
  const auto values = manifest::values_of(info_, parameters, place);  // in the order above
  return sphere_emitter(values[0], values[1], values[2].x);
}

}  // namespace gonio::light
