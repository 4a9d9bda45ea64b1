// A light-emitting diode: a small lamp whose intensity falls with the angle theta from its axis,
//   I = watt_per_sr cos(theta)^exponent                                                (Moreno, Avendano-Alejo &
//   Tzonchev 2006, equation 1)
// exponent 1 is a bare chip; an opening angle of half the intensity, theta_half, has exponent -ln 2 / ln
// cos(theta_half) (60 degrees: 1; 20 degrees: 11.1). With radius_m > 0 it is a disc across the axis: light/aimed.h.
#include "light/aimed.h"

namespace gonio::light {
namespace {

enum : std::size_t { position_index, direction_index, intensity_index, radius_index, exponent_index };

class LedModel final : public Model {
 public:
  const manifest::ModelInfo& info() const override {
    static const manifest::ModelInfo info{
        .family = manifest::Family::light,
        .id = "led",
        .sentence = "A light-emitting diode: a small lamp that shines about its axis and fades to the sides.",
        .source = "Moreno, Avendano-Alejo & Tzonchev 2006, equation 1",
        .parameters = {position_info("where the diode is, in the world frame"),
                       direction_info(),
                       intensity_info("radiant intensity on the axis of linear red, green and blue"),
                       {.name = "radius_m",
                        .unit = "m",
                        .preset = 0,
                        .lower = 0,
                        .meaning = "radius of the shining disc; 0 is a point"},
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

const Model& led() {
  static const LedModel model;
  return model;
}

}  // namespace gonio::light
