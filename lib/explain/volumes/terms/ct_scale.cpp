// ct.scale on walls: they move with their distance from the middle, seen along the normal.
#include <algorithm>
#include <cmath>

#include "explain/volumes/volume_term.h"

namespace gonio::mechanism {
const Mechanism& ct_scale();
}

namespace gonio::explain::volumes::terms {

const Term& ct_scale() {
  static const Term term{.mechanism = mechanism::ct_scale,
                         .order = 100,
                         .forms = {{{"scale"}, false}, {{"scale", "axial"}, true}},
                         .act = [](double value, const Row& row, const Observed& o, std::span<const double> p) {
                           if (row.reading != Reading::wall) return value;
                           return value +
                                  (p[0] * dot(row.at_m, row.normal) + p[1] * row.at_m.z * row.normal.z) / o.voxel_m;
                         }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
