// scene.moved: what it was is not stated, only where and by how much. render shows what all pictures have in common.
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& scene_moved();
}

namespace gonio::scene::edits {

const Edit& scene_moved() {
  static const Edit edit{.mechanism = mechanism::scene_moved, .beyond_rendering = true};
  return edit;
}

}  // namespace gonio::scene::edits
