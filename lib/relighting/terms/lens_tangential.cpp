// lens.tangential: rays of the views that scene/mechanisms.h makes (relighting/shifted_views.h).
#include "relighting/shifted_views.h"

namespace gonio::mechanism {
const Mechanism& lens_tangential();
}

namespace gonio::relighting::terms {

const Term& lens_tangential() {
  static const Term term = shifted_term(mechanism::lens_tangential,
                                        [](const Setting& s) { return shifted_uses(s, mechanism::lens_tangential()); });
  return term;
}

}  // namespace gonio::relighting::terms
