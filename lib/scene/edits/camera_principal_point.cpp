// camera.principal-point: where the axis meets the sensor of a view.
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& camera_principal_point();
}

namespace gonio::scene::edits {
namespace {

void move_axis(View& view, const Amounts& a) {
  camera::Intrinsics lens = view.camera.intrinsics();
  lens.cx_px += a[0], lens.cy_px += a[1];
  view.camera = view.camera.with(lens);
}

}  // namespace

const Edit& camera_principal_point() {
  static const Edit edit{.mechanism = mechanism::camera_principal_point, .view = move_axis, .rays = true};
  return edit;
}

}  // namespace gonio::scene::edits
