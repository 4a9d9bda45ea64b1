// surface.coating: what is seen of a mirror under a film is explain's (explain/polarization/coat.h).
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& surface_coating();
}

namespace gonio::scene::edits {

const Edit& surface_coating() {
  static const Edit edit{.mechanism = mechanism::surface_coating, .beyond_rendering = true};
  return edit;
}

}  // namespace gonio::scene::edits
