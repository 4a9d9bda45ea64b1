// optics.vignetting: scene::vignetting() of the amount.
#include "scene/mechanisms/optics_vignetting.h"

#include "relighting/uses.h"

namespace gonio::relighting::terms {

const Term& optics_vignetting() {
  static const Term term{
      .mechanism = mechanism::optics_vignetting,
      .reach = Reach::compose,
      .candidates =
          [](const Setting& s) {
            if (switched_on(s.document, mechanism::optics_vignetting().id)) return std::vector<Use>{};
            return std::vector{scene_use(mechanism::optics_vignetting())};
          },
      .edit = [](const Use& use, std::size_t, const SceneLayout&, const Recordings&,
                 SceneState& state) { state.falloff = use.amounts(state)[0]; },
  };
  return term;
}

}  // namespace gonio::relighting::terms
