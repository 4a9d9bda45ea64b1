// geometry.pose: scene/placement.cpp on rays cast anew (relighting/recast.h).
#include "relighting/recast.h"

namespace gonio::mechanism {
const Mechanism& geometry_pose();
}

namespace gonio::relighting::terms {

const Term& geometry_pose() {
  static const Term term = recast_term(mechanism::geometry_pose,
                                       [](const Setting& s) { return object_uses(s, mechanism::geometry_pose()); });
  return term;
}

}  // namespace gonio::relighting::terms
