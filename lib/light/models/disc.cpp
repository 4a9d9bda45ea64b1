// A flat round lamp that shines to one side. With exponent 1 its radiance is watt_per_sr / (pi radius_m^2) in all
// directions (Lambert's law), and a facing plane on the axis at the distance d receives pi L sin^2(s), tan(s) =
// radius_m / d. Sampling and emission: light/aimed.h.
#include "light/aimed.h"

namespace gonio::light {
namespace {

enum : std::size_t { position_index, direction_index, intensity_index, radius_index, exponent_index };

class DiscModel final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::light,
        .id = "disc",
        .sentence = "A flat round lamp that shines to one side, as an integrating sphere's port does.",
        .source = "Lambert 1760; concentric map of Shirley & Chiu 1997",
        .parameters =
            {position_info("centre of the disc, in the world frame"),
             direction_info(),
             intensity_info("radiant intensity on the axis, seen from afar, of linear red, green and blue"),
             {.name = "radius_m", .unit = "m", .preset = {}, .lower = 0, .meaning = "radius of the disc; 0 is a point"},
             exponent_info(1)},
    };
    return info;
  }
  std::unique_ptr<Emitter> prepare(const manifest::Parameters& parameters, const Attachment&,
                                   const std::string& place) const override {
    const auto v = manifest::values_of(info(), parameters, place);
    return aimed_lamp(v[position_index], lamp_frame(v[direction_index], {}, place), v[intensity_index],
                      v[radius_index].x, cosine_lobe(v[exponent_index].x));
  }
};

}  // namespace

const Model& disc() {
  static const DiscModel model;
  return model;
}

}  // namespace gonio::light
