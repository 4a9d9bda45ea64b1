// geometry.scale: scene/placement.cpp on rays cast anew (relighting/recast.h).
#include "relighting/recast.h"

namespace gonio::mechanism {
const Mechanism& geometry_scale();
}

namespace gonio::relighting::terms {

const Term& geometry_scale() {
  static const Term term = recast_term(mechanism::geometry_scale,
                                       [](const Setting& s) { return object_uses(s, mechanism::geometry_scale()); });
  return term;
}

}  // namespace gonio::relighting::terms
