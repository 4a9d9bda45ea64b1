// lens.non-central: the pupil of a view's lens (camera/camera_model.h).
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& lens_non_central();
}

namespace gonio::scene::edits {
namespace {

void move_pupil(View& view, const Amounts& a) {
  view.camera = view.camera.with_pupil(a[0]);
}

}  // namespace

const Edit& lens_non_central() {
  static const Edit edit{.mechanism = mechanism::lens_non_central, .view = move_pupil, .rays = true};
  return edit;
}

}  // namespace gonio::scene::edits
