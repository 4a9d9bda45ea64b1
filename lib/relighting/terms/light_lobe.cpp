// light.lobe: one exponent for all lamps at a finite distance, each facing the scene's centre as in
// scene/mechanisms.cpp. Light between surfaces keeps that of lamps without a lobe.
#include "relighting/uses.h"

namespace gonio::mechanism {
const Mechanism& light_lobe();
}

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  const std::optional<Use> use =
      lamps_use(s, mechanism::light_lobe(), true,
                [](const Setting& here, std::size_t light) { return !here.layout.lights[light].directional; });
  return use ? std::vector<Use>{*use} : std::vector<Use>{};
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

}  // namespace gonio::relighting::terms
