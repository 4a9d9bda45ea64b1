// ct.cupping on grey values of the material: a parabola of the radius.
#include <algorithm>
#include <cmath>

#include "explain/volumes/volume_term.h"

namespace gonio::mechanism {
const Mechanism& ct_cupping();
}

namespace gonio::explain::volumes::terms {

const Term& ct_cupping() {
  static const Term term{.mechanism = mechanism::ct_cupping,
                         .order = 100,
                         .act = [](double value, const Row& row, const Observed& o, std::span<const double> p) {
                           if (row.reading != Reading::inside) return value;
                           const double r = std::hypot(row.at_m.x, row.at_m.y) / o.field_m;
                           return value * (1 + p[0] * (r * r - 0.5));
                         }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
