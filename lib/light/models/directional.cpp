// A lamp so far away that its rays are parallel: the sun, or a distant flash.
#include <cmath>

#include "base/error.h"
#include "light/light.h"

namespace gonio::light {
namespace {

enum : std::size_t { towards_index, irradiance_index };

class Directional final : public Emitter {
 public:
  Directional(Vec3 towards, Rgb watt_per_m2) : towards_(towards), watt_per_m2_(watt_per_m2) {}
  Sample sample(Vec3, Vec2) const override {
    return {towards_, std::numeric_limits<double>::infinity(), watt_per_m2_, 0, true, true};
  }
  Hit hit(Vec3, Vec3) const override { return {}; }

 private:
  Vec3 towards_;
  Rgb watt_per_m2_;
};

class DirectionalModel final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::light,
        .id = "directional",
        .sentence = "A distant lamp whose rays are parallel.",
        .source = "Lambert 1760",
        .parameters = {{.name = "towards",
                        .unit = "1",
                        .components = 3,
                        .preset = {},
                        .meaning =
                            "direction from the scene TO the light, in the world frame; its length does not matter"},
                       {.name = "watt_per_m2",
                        .unit = "W/m^2",
                        .components = 3,
                        .rgb = true,
                        .preset = {},
                        .lower = 0,
                        .meaning = "irradiance on a plane that faces the light, of linear red, green and blue"}},
    };
    return info;
  }
  std::unique_ptr<Emitter> prepare(const manifest::Parameters& parameters, const Attachment&,
                                   const std::string& place) const override {
    const auto values = manifest::values_of(info(), parameters, place);
    const double length = norm(values[towards_index]);
    if (!(length > 1e-9 && std::isfinite(length)))
      throw Error(Exit::data, place + "/towards", "direction has no length",
                  "give the vector from the scene to the light");
    return std::make_unique<Directional>(values[towards_index] / length, values[irradiance_index]);
  }
};

}  // namespace

const Model& directional() {
  static const DirectionalModel model;
  return model;
}

}  // namespace gonio::light
