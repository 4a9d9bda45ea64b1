// light.near-environment: surroundings that the base model states as many distant lamps, three or more at once, stand
// on walls about the scene's centre. Directions and distances: relighting/shading.h; here the cosine at the wall.
// Shadows, and light by way of surfaces, stay those of the distant lamps.
#include <algorithm>

#include "light/near_environment.h"
#include "relighting/image_model.h"
#include "relighting/uses.h"

namespace gonio::mechanism {
const Mechanism& light_near_environment();
}

namespace gonio::relighting::terms {
namespace {

std::vector<Use> candidates(const Setting& s) {
  if (!lamps_surround(s)) return {};
  std::optional<Use> use =
      lamps_use(s, mechanism::light_near_environment(), true,
                [](const Setting& here, std::size_t light) { return here.layout.lights[light].directional; });
  if (!use) return {};
  use->family = "nearness of the lamps";
  return {*use};
}

void edit(const Use& use, std::size_t, const SceneLayout&, const Recordings&, SceneState& state) {
  for (std::size_t t = 0; t < use.targets.size(); ++t)
    state.lights[use.targets[t]].nearness_per_m = use.amounts(state, t)[0];
}

void shade(const Use& use, const Frame& frame, Shading& shading) {
  const SceneLayout& layout = frame.model.layout();
  for (std::size_t t = 0; t < use.targets.size(); ++t) {
    const auto on = std::find(frame.image.lights.begin(), frame.image.lights.end(), use.targets[t]);
    const double nearness = use.amounts(frame.state, t)[0];
    if (on == frame.image.lights.end() || nearness == 0) continue;
    const auto j = static_cast<std::size_t>(on - frame.image.lights.begin());
    const Vec3 d = layout.lights[use.targets[t]].direction;
    const light::Walls walls{layout.centre_m, 1 / nearness};
    std::size_t slot = 0;
    for (const std::uint32_t p : frame.picked)
      for (std::size_t k = 0; k < frame.cache.pixels[p].facets; ++k, ++slot) {
        const Facet& facet = frame.cache.facets[frame.cache.pixels[p].first_facet + k];
        const Vec3 at_m = frame.cache.patches[facet.first_patch].position_m;
        const double cosine = std::max(0.0, dot(d, walls.seen(at_m, d).direction));
        Scattered& direct = shading.direct[slot * shading.lights + j];
        direct.base = direct.base * cosine;
        direct.gloss = direct.gloss * cosine;
      }
  }
}

}  // namespace

const Term& light_near_environment() {
  static const Term term{
      .mechanism = mechanism::light_near_environment,
      .reach = Reach::all,
      .candidates = candidates,
      .edit = edit,
      .shade = shade,
  };
  return term;
}

}  // namespace gonio::relighting::terms
