// colour.metamerism: of photographs of a chart whose reflectances are known. Scenes are rendered in three colours.
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& colour_metamerism();
}

namespace gonio::scene::edits {

const Edit& colour_metamerism() {
  static const Edit edit{.mechanism = mechanism::colour_metamerism, .beyond_rendering = true};
  return edit;
}

}  // namespace gonio::scene::edits
