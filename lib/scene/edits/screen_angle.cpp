// screen.angle: the direction that a screen's section states.
#include "light/mechanisms/screen_angle.h"

#include <cmath>

#include "scene/edit.h"
#include "scene/model_choice.h"

namespace gonio::scene::edits {
namespace {

constexpr const char* stated = "polarization_rad";

bool is_polarized(const Light& light) {
  return find_parameter(light.model->info(), stated) != nullptr;
}
// Half a turn is none: the result stays within what sections may state.
void turn(Light& light, const Amounts& amounts, Vec3, const std::string&) {
  const auto given = light.parameters.find(stated);
  const double axis = given != light.parameters.end() && given->second.given() ? given->second.scalar() : 0;
  light.parameters[stated] = manifest::Parameter(std::remainder(axis + amounts[0], pi));
}

}  // namespace

const Edit& screen_angle() {
  static const Edit edit{.mechanism = mechanism::screen_angle, .fits_light = is_polarized, .light = turn};
  return edit;
}

}  // namespace gonio::scene::edits
