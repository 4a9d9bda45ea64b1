// light.second-source: a distant lamp that is on in every image and called after its mechanism.
#include <cmath>

#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& light_second_source();
}

namespace gonio::scene::edits {
namespace {

void add_second_source(Appearance& appearance, const Amounts& a, const std::string& place) {
  if (a[0] == 0) return;
  Light light;
  light.id = mechanism::light_second_source().id;
  light.model = light::find("directional");
  light.parameters["towards"] = manifest::Parameter(
      std::vector<double>{std::cos(a[2]) * std::cos(a[1]), std::cos(a[2]) * std::sin(a[1]), std::sin(a[2])});
  light.parameters["watt_per_m2"] = manifest::Parameter(std::vector<double>{a[0], a[0], a[0]});
  if (!appearance.lights.empty()) light.bands = appearance.lights[0].bands;
  refresh(light, place);
  appearance.lights.push_back(std::move(light));
}

}  // namespace

const Edit& light_second_source() {
  static const Edit edit{.mechanism = mechanism::light_second_source, .appearance = add_second_source};
  return edit;
}

}  // namespace gonio::scene::edits
