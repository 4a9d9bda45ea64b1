// camera.rolling-shutter: rays of the views that scene/mechanisms.h makes (relighting/shifted_views.h).
#include "relighting/shifted_views.h"

namespace gonio::mechanism {
const Mechanism& camera_rolling_shutter();
}

namespace gonio::relighting::terms {

const Term& camera_rolling_shutter() {
  static const Term term = shifted_term(mechanism::camera_rolling_shutter, [](const Setting& s) {
    return shifted_uses(s, mechanism::camera_rolling_shutter());
  });
  return term;
}

}  // namespace gonio::relighting::terms
