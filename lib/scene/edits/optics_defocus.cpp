// optics.defocus: views get a lens.
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& optics_defocus();
}

namespace gonio::scene::edits {

const Edit& optics_defocus() {
  static const Edit edit{.mechanism = mechanism::optics_defocus, .view = [](View& view, const Amounts& p) {
                           view.lens = {.aperture_radius_m = p[0], .focus_m = p[1]};
                         }};
  return edit;
}

}  // namespace gonio::scene::edits
