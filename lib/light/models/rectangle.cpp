// A flat rectangular lamp that shines to one side: a soft box, a panel. Radiance towards the emission angle theta
//   L = watt_per_sr cos(theta)^(exponent - 1) / (width_m height_m),
// the same in all directions at exponent 1. Directions are drawn uniformly over the solid angle (light/panel.h):
// weight = L / pdf. Photons leave the area uniformly along a lobe cos^exponent: flux = 2 pi watt_per_sr / (exponent+1).
#include <cmath>

#include "light/aimed.h"
#include "light/panel.h"
#include "light/warp.h"

namespace gonio::light {
namespace {

enum : std::size_t {
  position_index,
  direction_index,
  up_index,
  width_index,
  height_index,
  intensity_index,
  exponent_index
};

class Rectangle final : public Emitter {
 public:
  Rectangle(const Panel& panel, Rgb watt_per_sr, double exponent)
      : panel_(panel), watt_per_sr_(watt_per_sr), exponent_(exponent) {}

  Sample sample(Vec3 point_m, Vec2 u) const override {
    const PanelView view(panel_, point_m);
    if (!view.seen()) return {};
    const Vec2 at = view.draw(u);
    const Vec3 arm = panel_.at(at.x, at.y) - point_m;
    const double distance = norm(arm), cosine = -dot(arm, panel_.frame.n) / distance;
    if (!(cosine > 1e-9)) return {};
    const double density = view.pdf(distance, cosine);
    return {arm / distance, distance, radiance(cosine) / density, density, false, true};
  }
  Hit hit(Vec3 origin_m, Vec3 direction) const override {
    const auto met = panel_.meet(origin_m, direction);
    if (!met) return {};
    const PanelView view(panel_, origin_m);
    if (!view.seen()) return {};
    return {met->distance_m, radiance(met->cosine), view.pdf(met->distance_m, met->cosine)};
  }
  Emission emit(Vec2 u_position, Vec2 u_direction) const override {
    return {panel_.at((u_position.x - 0.5) * panel_.width_m, (u_position.y - 0.5) * panel_.height_m),
            panel_.frame.to_world(on_lobe(u_direction, exponent_)), watt_per_sr_ * (2 * pi / (exponent_ + 1)), true};
  }

 private:
  Rgb radiance(double cosine) const {
    return watt_per_sr_ * ((exponent_ == 1 ? 1 : std::pow(cosine, exponent_ - 1)) / panel_.area_m2());
  }
  Panel panel_;
  Rgb watt_per_sr_;
  double exponent_;
};

class RectangleModel final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::light,
        .id = "rectangle",
        .sentence = "A flat rectangular lamp that shines to one side: a soft box, a panel.",
        .source = "Urena, Fajardo & King 2013; irradiance: Lambert 1760",
        .parameters = {position_info("centre of the rectangle, in the world frame"),
                       direction_info(),
                       up_info(),
                       {.name = "width_m", .unit = "m", .preset = {}, .lower = 1e-6, .meaning = "size across `up`"},
                       {.name = "height_m", .unit = "m", .preset = {}, .lower = 1e-6, .meaning = "size along `up`"},
                       intensity_info("radiant intensity on the axis, seen from afar, of linear red, green and blue"),
                       exponent_info(1)},
    };
    return info;
  }
  std::unique_ptr<Emitter> prepare(const manifest::Parameters& parameters, const Attachment&,
                                   const std::string& place) const override {
    const auto v = manifest::values_of(info(), parameters, place);
    const Panel panel{v[position_index], lamp_frame(v[direction_index], v[up_index], place), v[width_index].x,
                      v[height_index].x};
    return std::make_unique<Rectangle>(panel, v[intensity_index], v[exponent_index].x);
  }
};

}  // namespace

const Model& rectangle() {
  static const RectangleModel model;
  return model;
}

}  // namespace gonio::light
