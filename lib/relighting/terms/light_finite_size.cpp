// light.finite-size: penumbrae from the cache's table of radii. One radius for all lamps: they are of one kind.
#include "relighting/uses.h"

namespace gonio::mechanism {
const Mechanism& light_finite_size();
}

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  std::optional<Use> use =
      lamps_use(s, mechanism::light_finite_size(), true, [](const Setting& here, std::size_t light) {
        return !here.layout.lights[light].directional && !(here.layout.start.lights[light].radius_m > 0);
      });
  if (!use) return {};
  use->numbers[0].upper = std::min(use->numbers[0].upper, radii_m.back());
  return {*use};
}

}  // namespace

const Term& light_finite_size() {
  static const Term term{
      .mechanism = mechanism::light_finite_size,
      .reach = Reach::all,
      .candidates = candidates,
      .edit =
          [](const Use& use, std::size_t, const SceneLayout&, const Recordings&, SceneState& state) {
            for (std::size_t t = 0; t < use.targets.size(); ++t)
              state.lights[use.targets[t]].radius_m = use.amounts(state, t)[0];
          },
  };
  return term;
}

}  // namespace gonio::relighting::terms
