// light.ambient: equation in light/models/uniform.cpp; open sky and light by way of surfaces from the cache.
#include "light/mechanisms/light_ambient.h"

#include "relighting/uses.h"

namespace gonio::relighting::terms {

const Term& light_ambient() {
  static const Term term{
      .mechanism = mechanism::light_ambient,
      .reach = Reach::compose,
      .candidates =
          [](const Setting& s) {
            if (switched_on(s.document, mechanism::light_ambient().id)) return std::vector<Use>{};
            return std::vector{scene_use(mechanism::light_ambient())};
          },
      .edit =
          [](const Use& use, std::size_t, const SceneLayout&, const Recordings&, SceneState& state) {
            const std::span<const double> radiance = use.amounts(state);
            state.ambient += Rgb{radiance[0], radiance[1], radiance[2]};
          },
  };
  return term;
}

}  // namespace gonio::relighting::terms
