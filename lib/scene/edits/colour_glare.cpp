// colour.glare: of photographs of a chart, on whose patches it was found. What a lens spreads over a rendered picture
// is optics.veiling-glare.
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& colour_glare();
}

namespace gonio::scene::edits {

const Edit& colour_glare() {
  static const Edit edit{.mechanism = mechanism::colour_glare, .beyond_rendering = true};
  return edit;
}

}  // namespace gonio::scene::edits
