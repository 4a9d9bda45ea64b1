// camera.focal-length: the magnification of a view, about its principal point.
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& camera_focal_length();
}

namespace gonio::scene::edits {
namespace {

void magnify(View& view, const Amounts& a) {
  camera::Intrinsics lens = view.camera.intrinsics();
  lens.fx_px *= 1 + a[0], lens.fy_px *= 1 + a[0];
  view.camera = view.camera.with(lens);
}

}  // namespace

const Edit& camera_focal_length() {
  static const Edit edit{.mechanism = mechanism::camera_focal_length, .view = magnify, .rays = true};
  return edit;
}

}  // namespace gonio::scene::edits
