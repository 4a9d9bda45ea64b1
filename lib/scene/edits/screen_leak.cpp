// screen.leak: the degree that a screen's section states.
#include "light/mechanisms/screen_leak.h"

#include "scene/edit.h"
#include "scene/model_choice.h"

namespace gonio::scene::edits {
namespace {

constexpr const char* stated = "polarization_degree";

bool is_polarized(const Light& light) {
  return find_parameter(light.model->info(), stated) != nullptr;
}
void depolarize(Light& light, const Amounts& amounts, Vec3, const std::string&) {
  const auto given = light.parameters.find(stated);
  const double degree = given != light.parameters.end() && given->second.given() ? given->second.scalar() : 1;
  light.parameters[stated] = manifest::Parameter(equation::screen_leak(degree, amounts[0]));
}

}  // namespace

const Edit& screen_leak() {
  static const Edit edit{.mechanism = mechanism::screen_leak, .fits_light = is_polarized, .light = depolarize};
  return edit;
}

}  // namespace gonio::scene::edits
