// light.near-environment: distant light comes from walls (light/near_environment.h). The model and its parameters stay.
#include "light/near_environment.h"
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& light_near_environment();
}

namespace gonio::scene::edits {
namespace {

bool surrounds(const Light& light) {
  return light.model->info().id == "directional" || (light.emitter && light.emitter->infinite());
}

void wall_in(Light& light, const Amounts& amounts, Vec3 centre_m, const std::string&) {
  const light::Walls walls{centre_m, 1 / amounts[0]};
  light.emitter = std::make_shared<const light::NearEnvironment>(light.emitter, walls);
}

}  // namespace

const Edit& light_near_environment() {
  static const Edit edit{.mechanism = mechanism::light_near_environment, .fits_light = surrounds, .light = wall_in};
  return edit;
}

}  // namespace gonio::scene::edits
