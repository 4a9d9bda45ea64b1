// camera.focal-length: rays of the views that scene/mechanisms.h makes (relighting/shifted_views.h).
#include "relighting/shifted_views.h"

namespace gonio::mechanism {
const Mechanism& camera_focal_length();
}

namespace gonio::relighting::terms {

const Term& camera_focal_length() {
  static const Term term = shifted_term(mechanism::camera_focal_length, [](const Setting& s) {
    return shifted_uses(s, mechanism::camera_focal_length());
  });
  return term;
}

}  // namespace gonio::relighting::terms
