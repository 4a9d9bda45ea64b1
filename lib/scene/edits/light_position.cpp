// light.position: lamps are moved.
#include "scene/edit.h"
#include "scene/model_choice.h"

namespace gonio::mechanism {
const Mechanism& light_position();
}

namespace gonio::scene::edits {
namespace {

bool can_shift(const Light& light) {
  return find_parameter(light.model->info(), "position_m") != nullptr;
}
void shift(Light& light, const Amounts& amounts, Vec3, const std::string&) {
  manifest::Parameter& position = light.parameters.at("position_m");
  position.value = components(position.vector() + Vec3{amounts[0], amounts[1], amounts[2]});
}

}  // namespace

const Edit& light_position() {
  static const Edit edit{.mechanism = mechanism::light_position, .fits_light = can_shift, .light = shift};
  return edit;
}

}  // namespace gonio::scene::edits
