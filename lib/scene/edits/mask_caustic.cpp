// mask.caustic: of masks, not of pictures, in which render finds all caustics by itself.
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& mask_caustic();
}

namespace gonio::scene::edits {

const Edit& mask_caustic() {
  static const Edit edit{.mechanism = mechanism::mask_caustic, .beyond_rendering = true};
  return edit;
}

}  // namespace gonio::scene::edits
