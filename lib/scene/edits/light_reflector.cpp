// light.reflector: a second lamp beside a lamp, on when that is; it shines by Lambert's law towards the lamp and
// beyond.
#include "base/error.h"
#include "scene/edit.h"
#include "scene/model_choice.h"

namespace gonio::mechanism {
const Mechanism& light_reflector();
}

namespace gonio::scene::edits {
namespace {

bool can_have_card(const Light& light) {
  return find_parameter(light.model->info(), "position_m") && find_parameter(light.model->info(), "watt_per_sr");
}

Light add_card(const Light& lamp, const Amounts& amounts, const std::string& place) {
  const Vec3 offset{amounts[1], amounts[2], amounts[3]};
  if (!(norm(offset) > 0))
    throw Error(Exit::data, place_of(place, "offset_x_m"), "puts the card into the lamp", "give the way to the card");
  Light card;
  card.model = light::find("led");
  card.parameters["position_m"] = manifest::Parameter(components(lamp.parameters.at("position_m").vector() + offset));
  card.parameters["direction"] = manifest::Parameter(components(-offset));
  card.parameters["exponent"] = manifest::Parameter(1.0);
  card.parameters["watt_per_sr"] =
      manifest::Parameter(components(lamp.parameters.at("watt_per_sr").rgb() * amounts[0]));
  card.bands = lamp.bands;
  return card;
}

}  // namespace

const Edit& light_reflector() {
  static const Edit edit{.mechanism = mechanism::light_reflector, .fits_light = can_have_card, .companion = add_card};
  return edit;
}

}  // namespace gonio::scene::edits
