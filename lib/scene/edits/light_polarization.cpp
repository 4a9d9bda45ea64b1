// light.polarization: a sheet before the lamp (light/polarized_emitter.h). The model and its parameters stay.
#include "light/polarized_emitter.h"
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& light_polarization();
}

namespace gonio::scene::edits {
namespace {

// From the scene's centre; zero for lamps that are all round.
Vec3 towards(const Light& light, Vec3 centre_m) {
  Vec3 arm;
  if (const auto given = light.parameters.find("towards"); given != light.parameters.end())
    arm = given->second.vector();
  else if (const auto place = light.parameters.find("position_m"); place != light.parameters.end())
    arm = place->second.vector() - centre_m;
  return norm(arm) > 0 ? normalized(arm) : Vec3{};
}

bool has_a_side(const Light& light) {
  return light.parameters.contains("towards") || light.parameters.contains("position_m");
}

void polarize(Light& light, const Amounts& amounts, Vec3 centre_m, const std::string&) {
  const Vec3 axis = towards(light, centre_m);
  if (axis == Vec3{}) return;  // in the centre itself: no sheet stands before it
  const light::Sheet sheet = light::Sheet::before(axis, amounts[0], amounts[1]);
  light.emitter = std::make_shared<const light::PolarizedEmitter>(light.emitter, sheet);
}

}  // namespace

const Edit& light_polarization() {
  static const Edit edit{.mechanism = mechanism::light_polarization, .fits_light = has_a_side, .light = polarize};
  return edit;
}

}  // namespace gonio::scene::edits
