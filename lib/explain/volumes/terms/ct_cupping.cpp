// ct.cupping on grey values of the material.
#include "volume/mechanisms/ct_cupping.h"

#include <cmath>

#include "explain/volumes/volume_term.h"

namespace gonio::explain::volumes::terms {

const Term& ct_cupping() {
  static const Term term{.mechanism = mechanism::ct_cupping,
                         .order = 100,
                         .act = [](double value, const Row& row, const Observed& o, std::span<const double> p) {
                           if (row.reading != Reading::inside) return value;
                           return equation::ct_cupping(value, p[0], std::hypot(row.at_m.x, row.at_m.y) / o.field_m);
                         }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
