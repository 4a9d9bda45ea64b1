// transport.indirect: light between surfaces, asked where the manifest has switched it off.
#include "relighting/uses.h"

namespace gonio::mechanism {
const Mechanism& transport_indirect();
}

namespace gonio::relighting::terms {

const Term& transport_indirect() {
  static const Term term{
      .mechanism = mechanism::transport_indirect,
      .reach = Reach::compose,
      .candidates =
          [](const Setting& s) {
            if (s.layout.start.indirect != 0) return std::vector<Use>{};
            return std::vector{scene_use(mechanism::transport_indirect())};
          },
      .edit = [](const Use& use, std::size_t, const SceneLayout&, const Recordings&,
                 SceneState& state) { state.indirect = use.amounts(state)[0]; },
  };
  return term;
}

}  // namespace gonio::relighting::terms
