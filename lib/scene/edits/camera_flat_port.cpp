// camera.flat-port: refraction before a view's lens (camera/camera_model.h).
#include "camera/mechanisms/camera_flat_port.h"

#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& camera_flat_port();
}

namespace gonio::scene::edits {
namespace {

void set_port(View& view, const Amounts& a) {
  view.camera = view.camera.with_port(equation::FlatPort{a[0], a[1], a[2], a[3]});
}

}  // namespace

const Edit& camera_flat_port() {
  static const Edit edit{.mechanism = mechanism::camera_flat_port, .view = set_port, .rays = true};
  return edit;
}

}  // namespace gonio::scene::edits
