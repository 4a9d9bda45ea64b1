// camera.aspect: the height of a view's pixels over their width.
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& camera_aspect();
}

namespace gonio::scene::edits {
namespace {

void stretch_columns(View& view, const Amounts& a) {
  camera::Intrinsics lens = view.camera.intrinsics();
  lens.fy_px *= 1 + a[0];
  view.camera = view.camera.with(lens);
}

}  // namespace

const Edit& camera_aspect() {
  static const Edit edit{.mechanism = mechanism::camera_aspect, .view = stretch_columns, .rays = true};
  return edit;
}

}  // namespace gonio::scene::edits
