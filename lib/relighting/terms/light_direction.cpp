// light.direction: lamps turned about the scene's centre; their shadows go with them.
#include "relighting/uses.h"

namespace gonio::mechanism {
const Mechanism& light_direction();
}

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  return all_or_one_lamp(s, mechanism::light_direction(), lamps_place, false,
                         [](const Setting&, std::size_t) { return true; });
}

}  // namespace

const Term& light_direction() {
  static const Term term{
      .mechanism = mechanism::light_direction,
      .reach = Reach::all,
      .candidates = candidates,
      .edit =
          [](const Use& use, std::size_t, const SceneLayout&, const Recordings&, SceneState& state) {
            for (std::size_t t = 0; t < use.targets.size(); ++t) {
              LightState& light = state.lights[use.targets[t]];
              light.tilt_x_rad = use.amounts(state, t)[0];
              light.tilt_y_rad = use.amounts(state, t)[1];
            }
          },
  };
  return term;
}

}  // namespace gonio::relighting::terms
