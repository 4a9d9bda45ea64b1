// light.position: lamps moved; their shadows stay where they fell. An alternative to light.direction for lamps at a
// finite distance: three numbers a lamp instead of two.
#include "relighting/uses.h"

namespace gonio::mechanism {
const Mechanism& light_position();
}

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  std::optional<Use> use = lamps_use(s, mechanism::light_position(), false, [](const Setting& here, std::size_t light) {
    return !here.layout.lights[light].directional;
  });
  if (!use) return {};
  for (std::size_t i = 0; i < use->numbers.size(); ++i)
    use->numbers[i].groups = lit_by(s.recordings, use->targets[i / 3]);
  use->family = lamps_place;
  return {*use};
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
