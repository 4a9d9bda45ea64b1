// light.second-source: a lamp that is on in every image and called after its mechanism.
#include <cmath>

#include "scene/edit.h"
#include "scene/model_choice.h"

namespace gonio::mechanism {
const Mechanism& light_second_source();
}

namespace gonio::scene::edits {
namespace {

void add_second_source(Appearance& appearance, const Amounts& a, Vec3 centre_m, const std::string& place) {
  if (a[0] == 0) return;
  const Vec3 towards{std::cos(a[2]) * std::cos(a[1]), std::cos(a[2]) * std::sin(a[1]), std::sin(a[2])};
  const double nearness_per_m = a[3];
  Light light;
  light.id = mechanism::light_second_source().id;
  if (nearness_per_m > 0) {
    light.model = light::find("point");
    light.parameters["position_m"] = manifest::Parameter(components(centre_m + towards / nearness_per_m));
    const double watt_per_sr = a[0] / (nearness_per_m * nearness_per_m);
    light.parameters["watt_per_sr"] = manifest::Parameter(std::vector<double>(3, watt_per_sr));
  } else {
    light.model = light::find("directional");
    light.parameters["towards"] = manifest::Parameter(components(towards));
    light.parameters["watt_per_m2"] = manifest::Parameter(std::vector<double>(3, a[0]));
  }
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
