// camera.pose: a view from elsewhere. In the frame of the stated camera: first the turn, then the shift.
#include "scene/edit.h"

namespace gonio::mechanism {
const Mechanism& camera_pose();
}

namespace gonio::scene::edits {
namespace {

void nudge(View& view, const Amounts& a) {
  const Rigid<frame::Camera, frame::Camera> moved{quaternion_of_rotation_vector({a[3], a[4], a[5]}),
                                                  {a[0], a[1], a[2]}};
  view.world_from_camera = view.world_from_camera * moved;
}

}  // namespace

const Edit& camera_pose() {
  static const Edit edit{.mechanism = mechanism::camera_pose, .view = nudge, .rays = true};
  return edit;
}

}  // namespace gonio::scene::edits
