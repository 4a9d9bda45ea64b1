// optics.vignetting: equation in scene/appearance.cpp, vignetting().
#include "explain/images/uses.h"

namespace gonio::mechanism {
const Mechanism& optics_vignetting();
}

namespace gonio::explain::images::terms {

const Term& optics_vignetting() {
  static const Term term{
      .mechanism = mechanism::optics_vignetting,
      .reach = Reach::compose,
      .candidates =
          [](const Setting& s) {
            if (switched_on(s.document, "optics.vignetting")) return std::vector<Use>{};
            return std::vector{scene_use(mechanism::optics_vignetting())};
          },
      .edit = [](const Use& use, std::size_t, const SceneLayout&, const Recordings&,
                 SceneState& state) { state.falloff = use.amounts(state)[0]; },
  };
  return term;
}

}  // namespace gonio::explain::images::terms
