// ct.ring on grey values: the rings that other sectors show.
#include <algorithm>
#include <cmath>

#include "explain/volumes/volume_term.h"

namespace gonio::mechanism {
const Mechanism& ct_ring();
}

namespace gonio::explain::volumes::terms {

const Term& ct_ring() {
  static const Term term{
      .mechanism = mechanism::ct_ring,
      .order = 300,
      .applies = [](const Observed& o) { return o.ring_rms > 0; },
      .act =
          [](double value, const Row& row, const Observed&, std::span<const double> p) {
            return row.reading == Reading::inside || row.reading == Reading::outside ? value + p[0] * row.ring : value;
          }};
  return term;
}

}  // namespace gonio::explain::volumes::terms
