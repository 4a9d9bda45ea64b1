// lens.thin-prism: rays of the views that scene/mechanisms.h makes (relighting/shifted_views.h).
#include "relighting/shifted_views.h"

namespace gonio::mechanism {
const Mechanism& lens_thin_prism();
}

namespace gonio::relighting::terms {

const Term& lens_thin_prism() {
  static const Term term = shifted_term(mechanism::lens_thin_prism,
                                        [](const Setting& s) { return shifted_uses(s, mechanism::lens_thin_prism()); });
  return term;
}

}  // namespace gonio::relighting::terms
