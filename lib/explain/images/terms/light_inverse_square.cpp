// light.inverse-square: lamps that the base model has at infinity; explain/images/shading.h has the equation. Their
// shadows, and their light by way of surfaces, stay those of parallel light.
#include "explain/images/uses.h"

namespace gonio::mechanism {
const Mechanism& light_inverse_square();
}

namespace gonio::explain::images::terms {
namespace {

// One nearness for all: lamps about an object stand at one distance.
std::vector<Use> candidates(const Setting& s) {
  std::vector<std::string> on;
  std::vector<std::size_t> lights;
  for (std::size_t l = 0; l < s.layout.lights.size(); ++l) {
    if (!s.layout.lights[l].directional || switched_on(s.document, "light.inverse-square", s.recordings.lights[l]))
      continue;
    on.push_back(s.recordings.lights[l]);
    lights.push_back(l);
  }
  if (on.empty()) return {};
  std::vector<Use> uses = {target_use(mechanism::light_inverse_square(), on, lights, true)};
  uses[0].family = "nearness of the lamps";
  return uses;
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

}  // namespace gonio::explain::images::terms
