// ct.blur on the widths of edges: variances add up.
#include <algorithm>
#include <cmath>

#include "explain/volumes/volume_term.h"

namespace gonio::mechanism {
const Mechanism& ct_blur();
}

namespace gonio::explain::volumes::terms {

const Term& ct_blur() {
  static const Term term{.mechanism = mechanism::ct_blur,
                         .order = 200,
                         .act = [](double value, const Row& row, const Observed&, std::span<const double> p) {
                           return row.reading == Reading::width ? std::hypot(value, p[0]) : value;
                         }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
