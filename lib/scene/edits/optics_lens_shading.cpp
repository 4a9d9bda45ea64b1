// optics.lens-shading: of a lens that takes pictures at several apertures. The camera here has none but its focus.
#include "scene/mechanisms/optics_lens_shading.h"

#include "scene/edit.h"

namespace gonio::scene::edits {

const Edit& optics_lens_shading() {
  static const Edit edit{.mechanism = mechanism::optics_lens_shading, .beyond_rendering = true};
  return edit;
}

}  // namespace gonio::scene::edits
