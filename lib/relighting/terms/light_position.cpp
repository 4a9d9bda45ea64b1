// light.position: lamps moved; their shadows go with them. An alternative to light.direction for lamps at a
// finite distance: three numbers a lamp instead of two.
#include "relighting/uses.h"

namespace gonio::mechanism {
const Mechanism& light_position();
}

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  return all_or_one_lamp(s, mechanism::light_position(), lamps_place, true,
                         [](const Setting& here, std::size_t light) { return !here.layout.lights[light].directional; });
}

}  // namespace

const Term& light_position() {
  static const Term term{
      .mechanism = mechanism::light_position,
      .reach = Reach::all,
      .candidates = candidates,
      .edit =
          [](const Use& use, std::size_t, const SceneLayout&, const Recordings&, SceneState& state) {
            for (std::size_t t = 0; t < use.targets.size(); ++t) {
              const std::span<const double> shift = use.amounts(state, t);
              state.lights[use.targets[t]].shift_m = {shift[0], shift[1], shift[2]};
            }
          },
  };
  return term;
}

}  // namespace gonio::relighting::terms
