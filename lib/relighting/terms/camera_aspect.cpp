// camera.aspect: rays of the views that scene/mechanisms.h makes (relighting/shifted_views.h).
#include "relighting/shifted_views.h"

namespace gonio::mechanism {
const Mechanism& camera_aspect();
}

namespace gonio::relighting::terms {

const Term& camera_aspect() {
  static const Term term = shifted_term(mechanism::camera_aspect,
                                        [](const Setting& s) { return shifted_uses(s, mechanism::camera_aspect()); });
  return term;
}

}  // namespace gonio::relighting::terms
