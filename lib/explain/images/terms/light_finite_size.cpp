// light.finite-size: penumbrae from the cache's table of radii. One radius for all lamps: they are of one kind.
#include "explain/images/uses.h"

namespace gonio::mechanism {
const Mechanism& light_finite_size();
}

namespace gonio::explain::images::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  std::vector<std::string> on;
  std::vector<std::size_t> lights;
  for (std::size_t l = 0; l < s.layout.lights.size(); ++l) {
    if (s.layout.lights[l].directional || s.layout.start.lights[l].radius_m > 0) continue;
    if (switched_on(s.document, "light.finite-size", s.recordings.lights[l])) continue;
    on.push_back(s.recordings.lights[l]);
    lights.push_back(l);
  }
  if (on.empty()) return {};
  Use use = target_use(mechanism::light_finite_size(), on, lights, true);
  use.numbers[0].upper = std::min(use.numbers[0].upper, radii_m.back());
  return {use};
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

}  // namespace gonio::explain::images::terms
