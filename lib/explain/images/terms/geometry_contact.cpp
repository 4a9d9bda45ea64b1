// geometry.contact: scene/placement.cpp on rays cast anew (explain/images/recast.h).
#include "explain/images/recast.h"

namespace gonio::mechanism {
const Mechanism& geometry_contact();
}

namespace gonio::explain::images::terms {

const Term& geometry_contact() {
  static const Term term = recast_term(mechanism::geometry_contact,
                                       [](const Setting& s) { return object_uses(s, mechanism::geometry_contact()); });
  return term;
}

}  // namespace gonio::explain::images::terms
