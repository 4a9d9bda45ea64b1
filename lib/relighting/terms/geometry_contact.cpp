// geometry.contact: scene/placement.cpp on rays cast anew (relighting/recast.h).
#include "relighting/recast.h"

namespace gonio::mechanism {
const Mechanism& geometry_contact();
}

namespace gonio::relighting::terms {

const Term& geometry_contact() {
  static const Term term = recast_term(mechanism::geometry_contact,
                                       [](const Setting& s) { return object_uses(s, mechanism::geometry_contact()); });
  return term;
}

}  // namespace gonio::relighting::terms
