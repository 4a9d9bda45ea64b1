// A small lamp that shines equally in all directions; with radius_m > 0 (mechanism light.finite-size) it is the sphere
// light.
#include "light/sphere_emitter.h"

namespace gonio::light {
namespace {

enum : std::size_t { position_index, intensity_index, radius_index };

class PointModel final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::light,
        .id = "point",
        .sentence = "A lamp too small to cast a penumbra; its irradiance falls with the square of the distance.",
        .source = "Lambert 1760; with radius_m > 0 as `sphere`",
        .parameters =
            {{.name = "position_m",
              .unit = "m",
              .components = 3,
              .preset = {},
              .meaning = "where the lamp is, in the world frame"},
             {.name = "watt_per_sr",
              .unit = "W/sr",
              .components = 3,
              .rgb = true,
              .preset = {},
              .lower = 0,
              .meaning = "radiant intensity of linear red, green and blue"},
             {.name = "radius_m", .unit = "m", .preset = 0, .lower = 0, .meaning = "radius of the lamp; 0 is a point"}},
    };
    return info;
  }
  std::unique_ptr<Emitter> prepare(const manifest::Parameters& parameters, std::shared_ptr<const io::Image>,
                                   const std::string& place) const override {
    const auto values = manifest::values_of(info(), parameters, place);
    return sphere_emitter(values[position_index], values[intensity_index], values[radius_index].x);
  }
};

}  // namespace

const Model& point() {
  static const PointModel model;
  return model;
}

}  // namespace gonio::light
