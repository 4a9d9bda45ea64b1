// camera.pose: rays of the views that scene/mechanisms.h makes (relighting/shifted_views.h).
#include "relighting/shifted_views.h"

namespace gonio::mechanism {
const Mechanism& camera_pose();
}

namespace gonio::relighting::terms {

const Term& camera_pose() {
  static const Term term =
      shifted_term(mechanism::camera_pose, [](const Setting& s) { return shifted_views(s, mechanism::camera_pose()); });
  return term;
}

}  // namespace gonio::relighting::terms
