// light.direction: lamps turned about the scene's centre; their shadows stay where they fell.
#include "relighting/uses.h"

namespace gonio::mechanism {
const Mechanism& light_direction();
}

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  std::optional<Use> use =
      lamps_use(s, mechanism::light_direction(), false, [](const Setting&, std::size_t) { return true; });
  if (!use) return {};
  for (std::size_t i = 0; i < use->numbers.size(); ++i)
    use->numbers[i].groups = lit_by(s.recordings, use->targets[i / 2]);
  use->family = lamps_place;
  return {*use};
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
