// geometry.offset: scene/placement.cpp on rays cast anew (relighting/recast.h).
#include "relighting/recast.h"

namespace gonio::mechanism {
const Mechanism& geometry_offset();
}

namespace gonio::relighting::terms {

const Term& geometry_offset() {
  static const Term term = recast_term(mechanism::geometry_offset,
                                       [](const Setting& s) { return object_uses(s, mechanism::geometry_offset()); });
  return term;
}

}  // namespace gonio::relighting::terms
