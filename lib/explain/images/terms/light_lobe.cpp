// light.lobe: one exponent for all lamps at a finite distance, each facing the scene's centre as in
// scene/mechanisms.cpp. Light between surfaces keeps that of lamps without a lobe.
#include "explain/images/uses.h"

namespace gonio::mechanism {
const Mechanism& light_lobe();
}

namespace gonio::explain::images::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  std::vector<std::string> on;
  std::vector<std::size_t> lights;
  for (std::size_t l = 0; l < s.layout.lights.size(); ++l) {
    if (s.layout.lights[l].directional || switched_on(s.document, "light.lobe", s.recordings.lights[l])) continue;
    on.push_back(s.recordings.lights[l]);
    lights.push_back(l);
  }
  if (on.empty()) return {};
  return {target_use(mechanism::light_lobe(), on, lights, true)};
}

}  // namespace

const Term& light_lobe() {
  static const Term term{
      .mechanism = mechanism::light_lobe,
      .reach = Reach::all,
      .candidates = candidates,
      .edit =
          [](const Use& use, std::size_t, const SceneLayout&, const Recordings&, SceneState& state) {
            for (std::size_t t = 0; t < use.targets.size(); ++t)
              state.lights[use.targets[t]].exponent = use.amounts(state, t)[0];
          },
  };
  return term;
}

}  // namespace gonio::explain::images::terms
