// The same radiance from every direction: an integrating sphere, an overcast sky all round, the white furnace.
// Directions are drawn uniformly over the sphere, pdf = 1 / (4 pi).
#include <cmath>

#include "light/light.h"

namespace gonio::light {
namespace {

class Uniform final : public Emitter {
 public:
  explicit Uniform(Rgb radiance) : radiance_(radiance) {}
  Sample sample(Vec3, Vec2 u) const override {
    const double z = 1 - 2 * u.x, r = 2 * std::sqrt(u.x * (1 - u.x)), phi = 2 * pi * u.y;
    return {{r * std::cos(phi), r * std::sin(phi), z},
            std::numeric_limits<double>::infinity(),
            radiance_ * (4 * pi),
            1 / (4 * pi),
            false,
            true};
  }
  Hit hit(Vec3, Vec3) const override { return {std::numeric_limits<double>::infinity(), radiance_, 1 / (4 * pi)}; }
  bool infinite() const override { return true; }

 private:
  Rgb radiance_;
};

class UniformModel final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::light,
        .id = "uniform",
        .sentence = "Ambient light: the same radiance from every direction.",
        .source = "irradiance of a plane: pi times the radiance",
        .parameters = {{.name = "radiance",
                        .unit = "W/(m^2 sr)",
                        .components = 3,
                        .rgb = true,
                        .preset = {},
                        .lower = 0,
                        .meaning = "radiance of linear red, green and blue"}},
    };
    return info;
  }
  std::unique_ptr<Emitter> prepare(const manifest::Parameters& parameters, const Attachment&,
                                   const std::string& place) const override {
    return std::make_unique<Uniform>(manifest::values_of(info(), parameters, place)[0]);
  }
};

}  // namespace

const Model& uniform() {
  static const UniformModel model;
  return model;
}

}  // namespace gonio::light
