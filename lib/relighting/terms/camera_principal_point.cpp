// camera.principal-point: rays of the views that scene/mechanisms.h makes (relighting/shifted_views.h).
#include "relighting/shifted_views.h"

namespace gonio::mechanism {
const Mechanism& camera_principal_point();
}

namespace gonio::relighting::terms {

const Term& camera_principal_point() {
  static const Term term = shifted_term(mechanism::camera_principal_point, [](const Setting& s) {
    return shifted_uses(s, mechanism::camera_principal_point());
  });
  return term;
}

}  // namespace gonio::relighting::terms
