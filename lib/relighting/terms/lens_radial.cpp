// lens.radial: rays of the views that scene/mechanisms.h makes (relighting/shifted_views.h).
#include "relighting/shifted_views.h"

namespace gonio::mechanism {
const Mechanism& lens_radial();
}

namespace gonio::relighting::terms {

const Term& lens_radial() {
  static const Term term =
      shifted_term(mechanism::lens_radial, [](const Setting& s) { return shifted_uses(s, mechanism::lens_radial()); });
  return term;
}

}  // namespace gonio::relighting::terms
