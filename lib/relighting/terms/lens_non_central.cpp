// lens.non-central: rays of the views that scene/mechanisms.h makes (relighting/shifted_views.h).
#include "relighting/shifted_views.h"

namespace gonio::mechanism {
const Mechanism& lens_non_central();
}

namespace gonio::relighting::terms {

const Term& lens_non_central() {
  static const Term term = shifted_term(
      mechanism::lens_non_central, [](const Setting& s) { return shifted_uses(s, mechanism::lens_non_central()); });
  return term;
}

}  // namespace gonio::relighting::terms
