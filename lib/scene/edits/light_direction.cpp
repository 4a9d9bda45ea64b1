// light.direction: lamps are turned about the scene's centre.
#include "light/turn.h"
#include "scene/edit.h"
#include "scene/model_choice.h"

namespace gonio::mechanism {
const Mechanism& light_direction();
}

namespace gonio::scene::edits {
namespace {

bool can_turn(const Light& light) {
  return find_parameter(light.model->info(), "towards") || find_parameter(light.model->info(), "position_m");
}
// Lamps that face somewhere are turned with their place, as if they hung from the scene's centre.
void turn(Light& light, const Amounts& amounts, Vec3 centre_m, const std::string&) {
  if (const auto towards = light.parameters.find("towards"); towards != light.parameters.end()) {
    const Vec3 given = towards->second.vector();
    towards->second.value = components(light::turned(normalized(given), amounts[0], amounts[1]) * norm(given));
  } else if (const auto position = light.parameters.find("position_m"); position != light.parameters.end()) {
    const Vec3 from = position->second.vector();
    position->second.value = components(light::turned_about(from, amounts[0], amounts[1], centre_m));
    for (const char* name : {"direction", "up"})
      if (const auto axis = light.parameters.find(name); axis != light.parameters.end() && axis->second.given())
        axis->second.value =
            components(light::turned_with(axis->second.vector(), from, amounts[0], amounts[1], centre_m));
  }
}

}  // namespace

const Edit& light_direction() {
  static const Edit edit{.mechanism = mechanism::light_direction, .fits_light = can_turn, .light = turn};
  return edit;
}

}  // namespace gonio::scene::edits
