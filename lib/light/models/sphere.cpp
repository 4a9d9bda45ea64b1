// A luminous sphere: uniform radiance watt_per_sr / (pi radius_m^2), so that far away it acts as the point light of
// that intensity.
#include "light/sphere_emitter.h"

namespace gonio::light {
namespace {

enum : std::size_t { position_index, intensity_index, radius_index };

class SphereModel final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::light,
        .id = "sphere",
        .sentence = "A luminous sphere, which casts a penumbra and shows as a disk in mirrors.",
        .source = "Shirley, Wang & Zimmerman 1996, section 3.2.1",
        .parameters = {{.name = "position_m",
                        .unit = "m",
                        .components = 3,
                        .preset = {},
                        .meaning = "centre of the sphere, in the world frame"},
                       {.name = "watt_per_sr",
                        .unit = "W/sr",
                        .components = 3,
                        .rgb = true,
                        .preset = {},
                        .lower = 0,
                        .meaning = "radiant intensity of linear red, green and blue"},
                       {.name = "radius_m",
                        .unit = "m",
                        .preset = {},
                        .lower = 0,
                        .meaning = "radius of the sphere; 0 is a point"}},
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

const Model& sphere() {
  static const SphereModel model;
  return model;
}

}  // namespace gonio::light
