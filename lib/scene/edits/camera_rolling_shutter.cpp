// camera.rolling-shutter: rows of a view that are read one after the other (camera/camera_model.h).
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& camera_rolling_shutter();
}

namespace gonio::scene::edits {
namespace {

void read_rows(View& view, const Amounts& a) {
  view.camera = view.camera.with_motion({a[0], a[1]});
}

}  // namespace

const Edit& camera_rolling_shutter() {
  static const Edit edit{.mechanism = mechanism::camera_rolling_shutter, .view = read_rows, .rays = true};
  return edit;
}

}  // namespace gonio::scene::edits
