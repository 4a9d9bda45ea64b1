// geometry.offset: scene/placement.cpp on rays cast anew (explain/images/recast.h).
#include "explain/images/recast.h"

namespace gonio::mechanism {
const Mechanism& geometry_offset();
}

namespace gonio::explain::images::terms {

const Term& geometry_offset() {
  static const Term term = recast_term(mechanism::geometry_offset,
                                       [](const Setting& s) { return object_uses(s, mechanism::geometry_offset()); });
  return term;
}

}  // namespace gonio::explain::images::terms
