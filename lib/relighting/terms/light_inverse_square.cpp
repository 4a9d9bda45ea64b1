// light.inverse-square: lamps that the base model has at infinity; relighting/shading.h has the equation. Their
// shadows, and their light by way of surfaces, stay those of parallel light.
#include "light/mechanisms/light_inverse_square.h"

#include "relighting/uses.h"

namespace gonio::relighting::terms {
namespace {

// One nearness for all: lamps about an object stand at one distance. Many at once are surroundings, the matter of
// light.near-environment.
std::vector<Use> candidates(const Setting& s) {
  if (lamps_surround(s)) return {};
  std::optional<Use> use =
      lamps_use(s, mechanism::light_inverse_square(), true,
                [](const Setting& here, std::size_t light) { return here.layout.lights[light].directional; });
  if (!use) return {};
  use->family = "nearness of the lamps";
  return {*use};
}

}  // namespace

const Term& light_inverse_square() {
  static const Term term{
      .mechanism = mechanism::light_inverse_square,
      .reach = Reach::all,
      .candidates = candidates,
      .edit =
          [](const Use& use, std::size_t, const SceneLayout&, const Recordings&, SceneState& state) {
            for (std::size_t t = 0; t < use.targets.size(); ++t)
              state.lights[use.targets[t]].nearness_per_m = use.amounts(state, t)[0];
          },
  };
  return term;
}

}  // namespace gonio::relighting::terms
