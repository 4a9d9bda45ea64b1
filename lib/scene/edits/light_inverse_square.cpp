// light.inverse-square: a lamp at 1 / nearness from the centre that gives a plane there what the distant one gave.
#include "light/mechanisms/light_inverse_square.h"

#include "scene/edit.h"
#include "scene/model_choice.h"

namespace gonio::scene::edits {
namespace {

bool can_come_near(const Light& light) {
  return light.model->info().id == "directional";
}
void come_near(Light& light, const Amounts& amounts, Vec3 centre_m, const std::string&) {
  const double distance_m = 1 / amounts[0];
  const Vec3 towards = normalized(light.parameters.at("towards").vector());
  const Rgb intensity = light.parameters.at("watt_per_m2").rgb() * (distance_m * distance_m);
  light.model = light::find("point");
  light.parameters = {{"position_m", manifest::Parameter(components(centre_m + towards * distance_m))},
                      {"watt_per_sr", manifest::Parameter(components(intensity))}};
}

}  // namespace

const Edit& light_inverse_square() {
  static const Edit edit{.mechanism = mechanism::light_inverse_square, .fits_light = can_come_near, .light = come_near};
  return edit;
}

}  // namespace gonio::scene::edits
