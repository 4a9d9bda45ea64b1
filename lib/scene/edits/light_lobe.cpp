// light.lobe: lamps that fade to the sides.
#include "base/error.h"
#include "scene/edit.h"
#include "scene/model_choice.h"

namespace gonio::mechanism {
const Mechanism& light_lobe();
}

namespace gonio::scene::edits {
namespace {

bool can_narrow(const Light& light) {
  return find_parameter(light.model->info(), "position_m") && model_for(light, mechanism::light_lobe());
}
// Adds to the exponent of the lamp; one that has none shone equally all round, and now faces the centre.
void narrow(Light& light, const Amounts& amounts, Vec3 centre_m, const std::string& place) {
  const manifest::ParameterInfo* own = find_parameter(light.model->info(), "exponent");
  light.model = model_for(light, mechanism::light_lobe());
  manifest::Parameter& exponent = light.parameters["exponent"];
  exponent = manifest::Parameter((exponent.given() ? exponent.scalar() : own ? *own->preset : 0) + amounts[0]);
  manifest::Parameter& direction = light.parameters["direction"];
  if (direction.given()) return;
  const Vec3 axis = centre_m - light.parameters.at("position_m").vector();
  if (!(norm(axis) > 0))
    throw Error(Exit::data, place_of(place, "on"),
                "\"" + light.id + "\" stands in the scene's centre and faces nowhere",
                "give it a model with a direction");
  direction = manifest::Parameter(components(axis));
}

}  // namespace

const Edit& light_lobe() {
  static const Edit edit{.mechanism = mechanism::light_lobe, .fits_light = can_narrow, .light = narrow};
  return edit;
}

}  // namespace gonio::scene::edits
