// A stage lamp: full within an inner cone, dark beyond an outer one. With theta from the axis, o = outer_rad and
// i = inner_share outer_rad,
//   I = watt_per_sr cos(theta)^exponent S(t),   t = (cos(theta) - cos(o)) / (cos(i) - cos(o)) clamped to 0 .. 1,
//   S(t) = 3 t^2 - 2 t^3                                       (Pharr, Jakob & Humphreys 2023, section 12.2.1)
// Photons leave by cos^exponent within the outer cone. With radius_m > 0 it is a disc across the axis: light/aimed.h.
#include <algorithm>
#include <array>
#include <cmath>

#include "light/aimed.h"
#include "light/mechanisms/light_lobe.h"
#include "light/warp.h"

namespace gonio::light {
namespace {

enum : std::size_t {
  position_index,
  direction_index,
  intensity_index,
  outer_index,
  inner_index,
  exponent_index,
  radius_index
};

class ConeLobe final : public Lobe {
 public:
  ConeLobe(double outer_rad, double inner_share, double exponent)
      : outer_(std::cos(outer_rad)), numbers_{exponent, outer_rad, inner_share} {}
  double relative(Vec3 local) const override {
    return local.z > std::max(0.0, outer_) ? equation::light_lobe(local.z, numbers_) : 0;
  }
  Draw draw(Vec2 u) const override { return {at_height(1 - u.x * (1 - outer_), u.y), 1 / (2 * pi * (1 - outer_))}; }

 private:
  double outer_;                   // cosine
  std::array<double, 3> numbers_;  // of light.lobe
};

class SpotModel final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::light,
        .id = "spot",
        .sentence = "A lamp that lights a cone: full inside, fading towards the cone's edge.",
        .source = "Pharr, Jakob & Humphreys 2023, section 12.2.1",
        .parameters = {position_info("where the lamp is, in the world frame"),
                       direction_info(),
                       intensity_info("radiant intensity on the axis of linear red, green and blue"),
                       {.name = "outer_rad",
                        .unit = "rad",
                        .preset = {},
                        .lower = 0.001,
                        .upper = pi / 2,
                        .meaning = "angle from the axis beyond which it is dark"},
                       {.name = "inner_share",
                        .unit = "1",
                        .preset = 0.8,
                        .lower = 0,
                        .upper = 1,
                        .meaning = "share of outer_rad within which the intensity is full; 1 is a hard edge"},
                       exponent_info(0),
                       {.name = "radius_m",
                        .unit = "m",
                        .preset = 0,
                        .lower = 0,
                        .meaning = "radius of the shining disc; 0 is a point"}},
    };
    return info;
  }
  std::unique_ptr<Emitter> prepare(const manifest::Parameters& parameters, const Attachment&,
                                   const std::string& place) const override {
    const auto v = manifest::values_of(info(), parameters, place);
    return aimed_lamp(v[position_index], lamp_frame(v[direction_index], {}, place), v[intensity_index],
                      v[radius_index].x,
                      std::make_shared<ConeLobe>(v[outer_index].x, v[inner_index].x, v[exponent_index].x));
  }
};

}  // namespace

const Model& spot() {
  static const SpotModel model;
  return model;
}

}  // namespace gonio::light
