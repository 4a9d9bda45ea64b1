// surface.fluorescence: re-radiation from band to band, which this path tracer does not follow.
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& surface_fluorescence();
}

namespace gonio::scene::edits {

const Edit& surface_fluorescence() {
  static const Edit edit{.mechanism = mechanism::surface_fluorescence, .beyond_rendering = true};
  return edit;
}

}  // namespace gonio::scene::edits
